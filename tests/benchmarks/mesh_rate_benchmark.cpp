// What the water mesh costs at the rate of a game: milliseconds of wall time per call, as the median of many.
//
// rate: a jet on a sagging cloth of 6,272 triangles, 0.3 s long, simulated with the settings for games at the
// spacing that gives about so many particles; cell 1 s, mode touch, gap 0.1 s, with velocities. Rows take
// turns, so that the load of the machine is the same for all of them.
//
// pairs: CPU seconds with keep_volume over those without it, taken in turns: the median of the ratios. dam: a
// full box of 111³ particles, cell ½ s; jet: the 10,000 particles above, cell 0.8 s.
//
// ellipsoids: those of the rows of `rate` alone.
//
// use: mesh_rate_benchmark [rate | pairs | ellipsoids | all = all] [threads = 2] [calls = 60] [particles =
// all]
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "oilskin/presets.h"
#include "oilskin/reconstruction.h"
#include "oilskin/world.h"
#include "reconstruction/scenes.h"
#include "support/static_mesh.h"

using namespace oilskin;

namespace {

double cpu_seconds() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return double(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * double(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

void expect(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s\n", status.message.c_str());
  std::exit(2);
}

/// The particles of a simulated jet, and the cloth below it, which does not move.
struct JetFrame {
  std::vector<Vec3> positions, velocities;
  test::StaticMesh cloth;
  double spacing = 0;

  ReconstructionInput input() const {
    ReconstructionInput in;
    in.positions = positions;
    in.velocities = velocities;
    in.obstacles.push_back({cloth.nodes, cloth.triangles});
    return in;
  }
};

JetFrame jet_frame(std::size_t particles) {
  constexpr double duration = 0.3, size = 0.5, pi = 3.14159265358979;  // [s], [m]
  DiscEmitter nozzle;
  nozzle.center = Vec3(0.5 * size, 0.5 * size, 0.05);
  nozzle.direction = Vec3(0, 0, -1);
  nozzle.radius = 0.025;
  nozzle.speed = 2;
  JetFrame frame;
  frame.spacing = std::cbrt(pi * nozzle.radius * nozzle.radius * nozzle.speed * duration / double(particles));
  frame.cloth.add_rectangle(Vec3::Zero(), size * Vec3::UnitX(), size * Vec3::UnitY(), 56, 56);
  for (Vec3& v : frame.cloth.nodes)
    v.z() = -0.12 * std::sin(pi * v.x() / size) * std::sin(pi * v.y() / size) +
            test::waves(v.x(), v.y(), 0.002, 0.11);
  const Preset preset = game_preset(frame.spacing);
  WorldSettings settings;
  settings.gravity = Vec3(0, 0, -9.81);
  World world(settings, preset.fluid, preset.contact);
  SurfaceSettings surface;
  surface.thickness = 0.001;
  expect(world.attach(frame.cloth, surface, nullptr));
  expect(world.add_emitter(nozzle));
  while (world.time() < duration) expect(world.step(preset.dt).status);
  frame.positions.assign(world.positions().begin(), world.positions().end());
  frame.velocities.assign(world.velocities().begin(), world.velocities().end());
  return frame;
}

ReconstructionOptions game_options(double spacing, int threads) {
  ReconstructionOptions options;
  options.spacing = spacing;
  options.cell = 1;
  options.contact = ObstacleMode::touch;
  options.gap = 0.1 * spacing;
  options.threads = threads;
  return options;
}

/// A way of meshing, and what it cost so far.
struct Row {
  const char* name;
  bool keep_volume, reuses;
  double shift = 0;  ///< of the cloth between calls [dx]: it moves to and fro
  std::vector<double> milliseconds = {}, cpu = {};
  std::vector<ReconstructionReport> reports = {};

  double stage(double ReconstructionSeconds::*of) const {
    std::vector<double> values;
    for (const ReconstructionReport& r : reports) values.push_back(1e3 * (r.seconds.*of));
    return median(values);
  }
};

void print(const JetFrame& frame, const Row& row, std::size_t triangles) {
  using S = ReconstructionSeconds;
  std::printf(
      "%7zu %-22s %7.2f ms, CPU %7.2f ms (blocks %.2f, field %.2f, contact %.2f, mesh %.2f, vertices %.2f); "
      "%zu triangles\n",
      frame.positions.size(), row.name, median(row.milliseconds), median(row.cpu), row.stage(&S::blocks),
      row.stage(&S::field), row.stage(&S::contact), row.stage(&S::mesh), row.stage(&S::vertices), triangles);
}

void print_ellipsoids(const JetFrame& frame, int threads, int calls) {
  EllipsoidOptions options;
  options.spacing = frame.spacing;
  options.gap = 0.1 * frame.spacing;
  options.threads = threads;
  std::vector<double> milliseconds;
  std::vector<WaterEllipsoid> ellipsoids;
  for (int call = 0; call < calls; ++call) {
    const double begin = wall_seconds();
    expect(make_ellipsoids(frame.input(), options, &ellipsoids));
    milliseconds.push_back(1e3 * (wall_seconds() - begin));
  }
  std::printf("%7zu %-22s %7.2f ms\n", frame.positions.size(), "ellipsoids", median(milliseconds));
}

void print_rate(std::size_t particles, int threads, int calls) {
  const JetFrame frame = jet_frame(particles);
  ReconstructionInput input = frame.input();
  std::vector<Vec3> cloth = frame.cloth.nodes;
  std::vector<Row> rows = {{"fresh", true, false},
                           {"fresh, no volume", false, false},
                           {"reuse", true, true, 1e-3},
                           {"reuse, cloth at rest", true, true},
                           {"reuse, no volume", false, true, 1e-3}};
  std::vector<WaterMesh> meshes(rows.size());
  std::vector<WaterMesher> meshers(rows.size());
  for (int call = 0; call < calls; ++call)
    for (std::size_t r = 0; r < rows.size(); ++r) {
      ReconstructionOptions options = game_options(frame.spacing, threads);
      options.keep_volume = rows[r].keep_volume;
      ReconstructionReport report;
      cloth = frame.cloth.nodes;
      for (Vec3& v : cloth) v.x() += call % 2 * rows[r].shift * frame.spacing;
      input.obstacles[0].vertices = cloth;
      const double begin = wall_seconds(), cpu_begin = cpu_seconds();
      if (rows[r].reuses)
        expect(meshers[r].reconstruct(input, options, &meshes[r], &report));
      else
        expect(reconstruct_surface(input, options, &meshes[r], &report));
      rows[r].milliseconds.push_back(1e3 * (wall_seconds() - begin));
      rows[r].cpu.push_back(1e3 * (cpu_seconds() - cpu_begin));
      rows[r].reports.push_back(report);
    }
  for (std::size_t r = 0; r < rows.size(); ++r) print(frame, rows[r], meshes[r].triangles.size());
  print_ellipsoids(frame, threads, calls);
}

void print_pairs(const char* name, const ReconstructionInput& input, ReconstructionOptions options,
                 int pairs) {
  std::vector<double> with, without, ratio;
  WaterMesh mesh;
  for (int pair = 0; pair < pairs; ++pair) {
    double seconds[2];
    for (const bool keeps : {false, true}) {
      options.keep_volume = keeps;
      const double begin = cpu_seconds();
      expect(reconstruct_surface(input, options, &mesh));
      seconds[keeps] = cpu_seconds() - begin;
    }
    without.push_back(seconds[0]);
    with.push_back(seconds[1]);
    ratio.push_back(seconds[1] / seconds[0]);
  }
  std::printf("%-4s %zu particles: %.4f CPU s, with keep_volume %.4f; ratio %.3f\n", name,
              input.positions.size(), median(without), median(with), median(ratio));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2, calls = argc > 3 ? std::atoi(argv[3]) : 60;
  if (what == "rate" || what == "all")
    for (const std::size_t particles : {1000, 3000, 10000, 30000})
      if (argc < 5 || particles == std::size_t(std::atoi(argv[4]))) print_rate(particles, threads, calls);
  if (what == "ellipsoids")
    for (const std::size_t particles : {1000, 3000, 10000, 30000})
      if (argc < 5 || particles == std::size_t(std::atoi(argv[4])))
        print_ellipsoids(jet_frame(particles), threads, calls);
  if (what == "pairs" || what == "all") {
    test::WaterScene dam;
    dam.spacing = 0.01;
    dam.add_water({Vec3::Zero(), Vec3::Constant(111 * dam.spacing)}, 0.2, 1);
    ReconstructionOptions options;
    options.spacing = dam.spacing;
    options.threads = threads;
    print_pairs("dam", dam.input(), options, std::max(3, calls / 10));
    const JetFrame frame = jet_frame(10000);
    ReconstructionOptions of_jet = game_options(frame.spacing, threads);
    of_jet.cell = 0.8;
    print_pairs("jet", frame.input(), of_jet, calls);
  }
  return 0;
}
