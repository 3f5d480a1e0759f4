#include "mesh_command.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "output/frame_path.h"
#include "output/surface_file.h"
#include "output/water_mesh.h"
#include "render/stored_frames.h"
#include "scene/fields.h"
#include "scene/mesh_options.h"
#include "scene/options.h"
#include "scene/scene_format.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

struct Plan {
  WaterMeshSettings mesh;
  double spacing = 0;                   // [m]
  double particle_mass = 0;             // [kg]; 0: unknown
  double rest_density = 0;              // [kg/m³]
  std::optional<double> other_density;  // of --density, where it is not that of the run
};

void read_report(const std::string& report, Plan& plan) {
  try {
    const Json whole = read_json_file(report);
    const Json& settings = whole.at("settings");
    plan.spacing = settings.at("fluid").at("spacing").get<double>();
    plan.rest_density = settings.at("fluid").value("rest_density", 0.0);
    plan.particle_mass = whole.value("mass", Json::object()).value("particle", 0.0);
    // As in a scene.
    if (settings.value("effects", Json::object()).contains("wetting")) plan.mesh.mode = ObstacleMode::wet;
    if (!settings.contains("surface")) return;
    if (!settings["surface"].is_object()) throw SceneError("settings.surface: must be an object");
    Fields fields = Fields::reader(settings["surface"], "settings.surface");
    describe(fields, plan.mesh);
    fields.finish();
  } catch (const Json::exception& e) {
    throw SceneError(report + ": is no report of a run (" + e.what() +
                     "); --spacing and a folder without it do, too");
  } catch (const SceneError& e) {
    throw SceneError(report + ": " + e.what());
  }
}

/// Keys of the scene's surface from --set.
Json surface_keys(const std::vector<std::string>& assignments) {
  Json scene = {{"surface", Json::object()}};
  for (const std::string& assignment : assignments) {
    if (assignment.find('=') == std::string::npos)
      throw SceneError("--set " + assignment + ": must be surface.KEY=VALUE, e.g. surface.min_blob=2");
    apply_override(scene, assignment);
    if (scene.size() > 1 || !scene["surface"].is_object())
      throw SceneError("--set " + assignment +
                       ": only keys of the surface count here, as surface.min_blob=2");
  }
  return scene["surface"];
}

void check_positive(const char* option, const std::optional<double>& value, const std::string& unit) {
  if (value && !(*value > 0))
    throw SceneError(std::string(option) + ": is " + std::to_string(*value) + ", must be > 0 " + unit);
}

/// Settings of the command line, and those of the run's report where it gives none.
Plan make_plan(const MeshOptions& options) {
  Plan plan;
  const std::string report = options.directory + "/report.json";
  if (fs::exists(report)) read_report(report, plan);
  check_positive("--spacing", options.spacing, "m");
  check_positive("--density", options.density, "kg/m3");
  if (options.spacing) plan.spacing = *options.spacing;
  if (options.density && *options.density != plan.rest_density)
    plan.rest_density = *(plan.other_density = options.density);
  if (!(plan.spacing > 0))
    throw SceneError("--spacing: is needed, in metres, where " + report +
                     " does not tell the particles' spacing");
  const Json keys = surface_keys(options.set);
  Fields set = Fields::reader(keys, "--set surface");
  describe(set, plan.mesh);
  set.finish();
  Json given = Json::object();
  if (options.cell) given["cell"] = *options.cell;
  if (options.gap) given["gap"] = *options.gap;
  if (!options.mode.empty()) given["mode"] = options.mode;
  if (options.smoothing) given["smoothing"] = *options.smoothing;
  if (!options.formats.empty()) given["formats"] = options.formats;
  if (!options.channels.empty()) given["channels"] = options.channels;
  Fields fields = Fields::reader(given, "");
  describe(fields, plan.mesh);
  return plan;
}

std::vector<int> wanted_frames(const MeshOptions& options, const std::vector<int>& all) {
  if (options.frames.empty()) return all;
  long long first = 0, last = 0;
  char end = 0;
  if (std::sscanf(options.frames.c_str(), "%lld:%lld%c", &first, &last, &end) != 2 || first < 0 ||
      first > last)
    throw SceneError("--frames " + options.frames + ": must be A:B, two frames with A <= B");
  std::vector<int> chosen;
  for (const int n : all)
    if (n >= first && n <= last) chosen.push_back(n);
  if (chosen.empty())
    throw SceneError("--frames " + options.frames + ": there are frames " + std::to_string(all.front()) +
                     " to " + std::to_string(all.back()));
  return chosen;
}

/// Where the meshes go.
struct Output {
  std::string directory, made_with;
  std::vector<std::string> formats;
};

SceneError made_with_other_options(const std::string& path, const std::string& there,
                                   const std::string& made) {
  const std::string options = there.empty() ? "unknown options" : there;
  return SceneError(path + ": is there already and was made with " + options + ", which are not " + made +
                    ". --overwrite makes it again, --out takes another folder");
}

/// A frame, and the formats of which it has no file yet.
struct Task {
  int number;
  std::vector<std::string> formats;
};

/// One that was made with other options would not fit the others. A copy that was cut off is made again.
std::vector<std::string> missing_formats(const MeshOptions& options, const Output& output, int number) {
  std::vector<std::string> missing;
  for (const std::string& format : output.formats) {
    const std::string path = frame_path(output.directory, "surface", number, format.c_str());
    if (options.overwrite || !fs::exists(path)) {
      missing.push_back(format);
      continue;
    }
    const std::string there = surface_made_with(path, format);
    if (there != output.made_with) throw made_with_other_options(path, there, output.made_with);
    if (!surface_is_whole(path, format)) missing.push_back(format);
  }
  return missing;
}

std::vector<Task> missing_tasks(const MeshOptions& options, const Output& output,
                                const std::vector<int>& frames) {
  std::vector<Task> tasks;
  for (const int number : frames)
    if (std::vector<std::string> formats = missing_formats(options, output, number); !formats.empty())
      tasks.push_back({number, std::move(formats)});
  return tasks;
}

/// Whether the run's own particles have the water of cubes with the edge `spacing`. Then it is right, however
/// densely they lie.
bool is_spacing_of_run(const Plan& plan, const MeshOptions& options) {
  if (options.spacing || options.density || !(plan.particle_mass > 0)) return false;
  constexpr double off = 2;  // wrong units are off by 1e3 or more
  const double share = plan.particle_mass / (plan.rest_density * std::pow(plan.spacing, 3));
  return share > 1 / off && share < off;
}

/// A frame whose particles are as far apart as the plan says.
StoredFrame read_frame(const StoredFrames& stored, int number, const Plan& plan, const MeshOptions& options) {
  StoredFrame frame = stored.read(number);
  if (is_spacing_of_run(plan, options)) return frame;
  const std::string name =
      options.spacing ? "--spacing" : options.directory + "/report.json: settings.fluid.spacing";
  if (const Status s = check_spacing(frame.position, plan.spacing, name); !s.ok())
    throw SceneError(s.message);
  return frame;
}

/// The water of each particle [m³]; none where its mass or the density is unknown.
std::vector<double> volumes_of(const StoredFrame& frame, int number, const Plan& plan) {
  if (!(plan.rest_density > 0)) return {};
  std::vector<double> volumes;
  const double most = max_particle_volume(plan.spacing);
  for (std::size_t i = 0; i < frame.mass.size(); ++i) {
    volumes.push_back(frame.mass[i] / plan.rest_density);
    if (volumes[i] >= 0 && volumes[i] <= most) continue;
    std::ostringstream text;
    text << "frame " << number << ": the mass of particle " << i << " is " << frame.mass[i]
         << " kg; with a density of " << plan.rest_density << " kg/m3 and a spacing of " << plan.spacing
         << " m it must be 0 to " << most * plan.rest_density << " kg";
    throw SceneError(text.str());
  }
  if (!volumes.empty() || !(plan.particle_mass > 0)) return volumes;
  return water_volumes(frame.position.size(), {}, plan.particle_mass, plan.rest_density);
}

ReconstructionInput input_of(const StoredFrame& frame, Span<const double> volumes) {
  ReconstructionInput input;
  input.positions = frame.position;
  input.volumes = volumes;
  input.velocities = frame.velocity;
  for (const StoredMesh& mesh : frame.obstacles)
    input.obstacles.push_back({mesh.vertices, mesh.triangles, mesh.wetness});
  return input;
}

/// Of all particles [m³].
double water_in(const ReconstructionInput& input, double spacing) {
  if (input.volumes.empty()) return double(input.positions.size()) * std::pow(spacing, 3);
  return std::accumulate(input.volumes.begin(), input.volumes.end(), 0.0);
}

void print_frame(int number, const MadeMesh& made, const ReconstructionInput& input, double spacing) {
  const MeshCheck& c = made.check;
  std::size_t triangles = 0;
  for (const ObstacleMesh& obstacle : input.obstacles) triangles += obstacle.triangles.size();
  std::printf(
      "frame %04d: %zu triangles, %.3f s, %zu obstacles of %zu triangles, %zu intersecting pairs, %zu nearer "
      "than the gap, %zu submerged, %zu open edges, ",
      number, made.mesh.triangles.size(), made.seconds, input.obstacles.size(), triangles,
      c.intersecting_pairs, c.too_close_pairs, c.submerged_components, c.open_edges);
  if (std::isfinite(c.min_distance))
    std::printf("least distance %g m, ", c.min_distance);
  else
    std::printf("no obstacle near, ");
  std::printf("volume %g m3 of %g m3 of water\n", c.volume, water_in(input, spacing));
  if (made.report.particles_skipped > 0)
    std::printf(
        "  %zu particles were left out: position or velocity not finite, or farther away than 2^20 cells\n",
        made.report.particles_skipped);
  std::fflush(stdout);
}

Plan checked_plan(const MeshOptions& options) {
  Plan plan = make_plan(options);
  if (const Status s = check_mesh_settings(plan.mesh, plan.spacing); !s.ok())
    throw SceneError("surface: " + s.message);
  require_formats(plan.mesh.formats);
  return plan;
}

Output make_output(const MeshOptions& options, const Plan& plan) {
  const std::string out = options.out.empty() ? options.directory : options.out;
  std::error_code error;
  if (!options.missing) fs::create_directories(out, error);
  if (error) throw SceneError("--out " + out + ": " + error.message());
  return {out, made_with(plan.mesh, plan.spacing, plan.other_density), plan.mesh.formats};
}

/// Lines about frames that may be wrong: of the first frame that has any.
class Doubts {
 public:
  void print(const std::vector<std::string>& doubts) {
    if (printed_) return;
    for (const std::string& doubt : doubts) std::printf("  note: %s\n", doubt.c_str());
    std::fflush(stdout);
    printed_ = !doubts.empty();
  }

 private:
  bool printed_ = false;
};

void print_other_files(const std::vector<std::string>& files) {
  if (files.empty()) return;
  std::printf("not read, as their names are not particles_NNNN.vtp, cloth_K_NNNN.ply or body_K_NNNN.ply: %s",
              files.front().c_str());
  if (files.size() > 1) std::printf(" and %zu more", files.size() - 1);
  std::printf("\n");
}

/// Whether the mesh is as promised.
bool make_frame(const StoredFrames& stored, const Task& task, const Plan& plan, const Output& output,
                const MeshOptions& options, Doubts& doubted) {
  const StoredFrame frame = read_frame(stored, task.number, plan, options);
  const std::vector<double> volumes = volumes_of(frame, task.number, plan);
  const ReconstructionInput input = input_of(frame, volumes);
  const ReconstructionOptions wanted = reconstruction_options(plan.mesh, plan.spacing, options.threads);
  const MadeMesh made = make_mesh(input, wanted);
  SurfaceFile file = surface_file(made.mesh, input, frame.id, plan.mesh, plan.spacing);
  file.made_with = output.made_with;
  write_surface(output.directory, task.number, task.formats, file);
  if (!options.quiet) {
    print_frame(task.number, made, input, plan.spacing);
    std::vector<std::string> doubts = doubts_about(frame.position, plan.spacing);
    if (!frame.mass.empty() && volumes.empty())
      doubts.push_back("the masses of the particles do not count: --density gives that of the water");
    doubted.print(doubts);
  }
  return made.as_promised(wanted.contact);
}

}  // namespace

int mesh_command(const MeshOptions& options) {
  const StoredFrames stored(options.directory);
  const std::vector<int> frames = wanted_frames(options, stored.numbers());
  const Plan plan = checked_plan(options);
  const Output output = make_output(options, plan);
  const std::vector<Task> tasks = missing_tasks(options, output, frames);
  // The last one: the first frame may hold no water, and its spacing could not be checked.
  if (!tasks.empty()) read_frame(stored, tasks.back().number, plan, options);
  if (options.missing) {
    for (const Task& task : tasks) std::printf("%d\n", task.number);
    return static_cast<int>(ExitCode::done);
  }
  if (!options.quiet) print_other_files(stored.other_files());
  bool good = true;
  Doubts doubted;
  for (const Task& task : tasks) {
    // Another process may have made it meanwhile.
    if (missing_formats(options, output, task.number).empty()) continue;
    good &= make_frame(stored, task, plan, output, options, doubted);
  }
  if (tasks.size() < frames.size() && !options.quiet)
    std::printf("%zu frames were there already; --overwrite makes them again\n",
                frames.size() - tasks.size());
  return static_cast<int>(good ? ExitCode::done : ExitCode::check_failed);
}

}  // namespace oilskin::demo
