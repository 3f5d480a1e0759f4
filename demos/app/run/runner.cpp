#include "run/runner.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <regex>

#include "checks/acceptance.h"
#include "hosts/scene_effects.h"
#include "hosts/step_plan.h"
#include "output/output_error.h"
#include "output/series.h"
#include "output/surface_file.h"
#include "output/trace_output.h"
#include "output/water_mesh.h"
#include "render/make_frames.h"
#include "run/progress.h"
#include "run/run_report.h"
#include "run/signals.h"
#include "scene/fields.h"
#include "scene/mesh_options.h"

namespace oilskin::demo {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of all threads of this process, user and system.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Frames of an earlier run must not stand beside those of this one.
void remove_old_frames(const std::string& directory) {
  static const std::regex ours(
      "(frame|particles)_[0-9]{4,}\\.(png|vtp)|(cloth|body)_[0-9]+_[0-9]{4,}\\.ply|surface_[0-9]{4,}\\.(ply|"
      "glb|vdb)("
      "\\.[0-9]+\\.part)?|"
      "run\\.pvd");
  std::vector<std::filesystem::path> old;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    if (entry.is_regular_file(error) && std::regex_match(entry.path().filename().string(), ours))
      old.push_back(entry.path());
  for (const auto& path : old) std::filesystem::remove(path, error);
}

/// Refuses a folder that cannot be written to before anything is computed.
std::string prepare_directory(const Scene& scene, const RunOptions& options) {
  std::string directory = options.out.empty() ? "out/" + scene.name : options.out;
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  const std::string probe = directory + "/report.json.part";
  std::ofstream file(probe);
  if (error || !file)
    throw SceneError("--out " + directory + ": the folder cannot be written to" +
                     (error ? ": " + error.message() : std::string()));
  file.close();
  std::filesystem::remove(probe, error);
  remove_old_frames(directory);
  return directory;
}

/// One run: the loop, its measurements and its end.
class Run {
 public:
  Run(const Scene& scene, const RunOptions& options, const MakeSimulation& make_simulation)
      : scene_(scene),
        options_(options),
        make_simulation_(make_simulation),
        acceptance_(scene),
        progress_(options.quiet, options.trace == "-"),
        directory_(prepare_directory(scene, options)),
        series_(scene, directory_),
        plan_(scene) {
    if (scene.water_mesh) require_formats(scene.water_mesh->formats);
    simulation_options_.threads = options.threads;
    simulation_ = make_simulation(scene, simulation_options_);
    open_frames();
    if (options.trace.empty()) return;
    trace_ = std::make_unique<TraceOutput>(options.trace, options.trace_steps);
    simulation_->world().set_observer(trace_.get());
  }

  int execute() {
    watch_signals();
    start_ = Clock::now();
    cpu_at_start_ = cpu_seconds();
    write_frame();
    const SimulatedTime& time = simulation_->time();
    while (!plan_.done(time) && caught_signal() == 0) {
      advance(time.steps());
      progress_.update(plan_.fraction(time), totals_.simulated, simulation_->world().particle_count(),
                       crossings());
      if (frames_ && !frames_->window_open()) break;
    }
    progress_.finish();
    return finish();
  }

 private:
  std::string crossings() const {
    return crossings_text(scene_.contact.verify, totals_.contact.crossings_found_by_verify);
  }

  void open_frames() {
    if (scene_.pictures.frames_per_second == 0 && !options_.view) return;
    std::string why;
    const bool wanted = options_.render.value_or(true);
    const bool can = pictures_available(&why);
    if ((options_.view || options_.render.value_or(false)) && !can)
      throw SceneError(std::string(options_.view ? "--view" : "--render") + ": " + why);
    if (wanted && !can)
      progress_.line("No pictures, and no particles_*.vtp, cloth_*.ply and body_*.ply: " + why + ".");
    FrameOptions frames;
    frames.directory = directory_;
    frames.files = scene_.pictures.frames_per_second > 0;
    frames.pictures = wanted && can && scene_.pictures.frames_per_second > 0;
    frames.window = options_.view;
    frames_ = make_frames(scene_, frames);
  }

  void advance(std::uint64_t s) {
    if (trace_) trace_->begin_step(s);
    const double t = simulation_->time().value();
    const double suggested = plan_.adaptive() ? simulation_->world().suggested_dt(scene_.dt) : scene_.dt;
    const StepReport& report = simulation_->step(plan_.next(t, suggested));
    if (!report.status.ok()) throw SceneError("step " + std::to_string(s) + ": " + report.status.message);
    totals_.add(report);
    series_.after_step(*simulation_, simulation_->world(), report);
    if (trace_) trace_->check();
    memory_.after_step(simulation_->time().value(), scene_.duration);
    acceptance_.after_step(*simulation_, report.dt);
    const double rate = scene_.pictures.frames_per_second > 0 ? scene_.pictures.frames_per_second : 30;
    if (plan_.reached(simulation_->time().value(), frame_number_ / rate)) write_frame();
  }

  void write_frame() {
    const bool files = scene_.pictures.frames_per_second > 0;
    if (!frames_ && !(scene_.water_mesh && files)) return;
    const Clock::time_point start = Clock::now();
    const double seconds_before = meshes_.seconds;
    const World& world = simulation_->world();
    FrameData data;
    data.t = totals_.simulated;
    data.id = world.ids();
    data.position = world.positions();
    data.velocity = world.motions();
    data.density = world.densities();
    data.pressure = world.pressures();
    data.mass_ratio = world.mass_ratios();
    data.particle_mass = world.particle_mass();
    for (std::size_t i = 0; i < scene_.cloth.size(); ++i) {
      const SurfaceMotion* const cloth = simulation_->cloth(i);
      data.cloth.push_back(cloth);
      data.wetness.push_back(cloth ? saturation(scene_, i, simulation_->models()[i], *cloth)
                                   : std::vector<float>());
    }
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) data.bodies.push_back(simulation_->body(i));
    data.crossings = crossings();
    std::optional<MadeMesh> made;
    if (scene_.water_mesh) made = make_water_mesh(data);
    if (made) data.water_mesh = &made->mesh;
    if (frames_) frames_->write(frame_number_, data);
    ++frame_number_;
    output_seconds_ += seconds_since(start) - (meshes_.seconds - seconds_before);
  }

  MadeMesh make_water_mesh(const FrameData& data) {
    ReconstructionInput input;
    input.positions = data.position;
    input.velocities = data.velocity;
    const std::vector<double> volumes =
        water_volumes(data.position.size(), data.mass_ratio, data.particle_mass, scene_.fluid.rest_density);
    input.volumes = volumes;
    for (std::size_t i = 0; i < data.cloth.size(); ++i)
      if (const SurfaceMotion* const s = data.cloth[i]; s != nullptr)
        input.obstacles.push_back({s->x_t1, s->triangles, data.wetness[i]});
    for (const SurfaceMotion* s : data.bodies)
      if (s != nullptr) input.obstacles.push_back({s->x_t1, s->triangles});
    MadeMesh made =
        make_mesh(input, reconstruction_options(*scene_.water_mesh, scene_.fluid.spacing, options_.threads));
    if (scene_.pictures.frames_per_second > 0)
      write_surface(directory_, frame_number_, scene_.water_mesh->formats,
                    surface_file(made.mesh, input, data.id, *scene_.water_mesh, scene_.fluid.spacing));
    meshes_.add(made);
    return made;
  }

  int finish() {
    memory_.finish();
    series_.finish();
    const double wall = seconds_since(start_), cpu = cpu_seconds() - cpu_at_start_;
    std::vector<CheckResult> checks;
    if (caught_signal() == 0)
      checks = acceptance_.results(
          {scene_, totals_, meshes_, memory_, *simulation_, simulation_options_, make_simulation_});
    RunSummary summary{scene_,  totals_,          memory_, acceptance_, checks,          *simulation_,
                       meshes_, options_.threads, wall,    cpu,         output_seconds_, caught_signal()};
    write_report(make_report(summary), directory_);
    print_summary(checks, wall);
    if (caught_signal() != 0) return static_cast<int>(ExitCode::signalled) + caught_signal();
    for (const CheckResult& c : checks)
      if (!c.ok) return static_cast<int>(ExitCode::check_failed);
    return static_cast<int>(ExitCode::done);
  }

  void print_summary(const std::vector<CheckResult>& checks, double wall) {
    char text[200];
    std::snprintf(text, sizeof text, "%s: %llu steps, %.3f s simulated in %.1f s, %llu particles emitted",
                  scene_.name.c_str(), static_cast<unsigned long long>(totals_.steps), totals_.simulated,
                  wall, static_cast<unsigned long long>(totals_.emitted));
    progress_.line(text);
    for (const std::string& note : scene_.notes) progress_.line("  note: " + note);
    for (const std::string& message : totals_.messages) progress_.line("  note: " + message);
    if (!totals_.energy_message.empty()) progress_.line("  note: " + totals_.energy_message);
    for (const std::string& flag : flag_texts(totals_.flags)) progress_.line("  flag: " + flag);
    for (const CheckResult& c : checks) {
      std::snprintf(text, sizeof text, "  %-18s %12.6g   limit %-10.6g %s", c.name.c_str(), c.value, c.limit,
                    c.ok ? "ok" : "FAILED");
      progress_.line(text);
    }
    explain_failed(checks);
    if (trace_ && trace_->is_empty())
      progress_.line("  note: the trace is empty: no step of --trace-steps is among the " +
                     std::to_string(totals_.steps) + " of the run");
    progress_.line("  " + directory_ + "/report.json");
  }

  /// The exit code must not be all that a quiet run says.
  void explain_failed(const std::vector<CheckResult>& checks) {
    std::string failed;
    for (const CheckResult& c : checks)
      if (!c.ok) failed += (failed.empty() ? "" : ", ") + c.name;
    if (failed.empty()) return;
    if (options_.duration)
      progress_.line("  note: the checks are made for the scene's own duration; --duration is another one");
    if (options_.quiet)
      std::fprintf(stderr, "oilskin: %s: checks failed: %s (%s/report.json)\n", scene_.name.c_str(),
                   failed.c_str(), directory_.c_str());
  }

  const Scene& scene_;
  const RunOptions& options_;
  const MakeSimulation& make_simulation_;
  Acceptance acceptance_;
  Progress progress_;
  std::string directory_;
  SimulationOptions simulation_options_;
  std::unique_ptr<TraceOutput> trace_;  // outlives the world that it watches
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<Frames> frames_;
  SeriesOutput series_;
  Totals totals_;
  ResidentMemory memory_;
  StepPlan plan_;
  Clock::time_point start_;
  double cpu_at_start_ = 0;  // [s]
  MeshTotals meshes_;
  double output_seconds_ = 0;
  int frame_number_ = 0;
};

}  // namespace

int run_scene(const Scene& scene, const RunOptions& options, const MakeSimulation& make_simulation) {
  Run run(scene, options, make_simulation);
  return run.execute();
}

}  // namespace oilskin::demo
