// What the surface costs: CPU seconds (all threads, the least of some runs) and the growth of peak memory
// beyond the particles and obstacles themselves; each row in a process of its own.
//
// dam: a full box of 111³ particles with jitter, cell ½ s. splashsurf 0.14 takes 5.4 to 6.6 s and 199 MB,
// OpenVDB 11.3 s and 194 MB on such a machine. sheet: two wavy layers, 2 m × 2 m, and a jet, 123,704
// particles; splashsurf 0.83 to 0.95 s and 90 MB, OpenVDB 1.4 s and 108 MB. jet: 15,000 particles on a
// sagging cloth of 6,272 triangles, s = 5 mm, in every mode of contact: seconds, and against the mesh that
// ignores the cloth and is as smooth; and its volume.
//
// use: surface_benchmark [dam | sheet | jet | scenes | all = all] [threads = 2] [runs = 3]
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "oilskin/reconstruction.h"
#include "reconstruction/scenes.h"

using namespace oilskin;

namespace {

double cpu_seconds() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return double(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * double(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

/// A line of /proc/self/status [MB].
double status_megabytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.compare(0, name.size(), name) == 0) return std::atof(line.c_str() + name.size() + 1) / 1024;
  return 0;
}

/// Makes the peak what is resident now.
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// In a process of its own, so that its peak memory is its own.
template <class F>
void apart(const F& f) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    f();
    std::fflush(stdout);
    _exit(0);
  }
  waitpid(child, nullptr, 0);
}

struct Measured {
  double seconds = 1e30, megabytes = 0;
  WaterMesh mesh;
  ReconstructionReport report;
};

Measured measure(const test::WaterScene& scene, const ReconstructionOptions& options, int runs) {
  Measured m;
  const ReconstructionInput input = scene.input();
  forget_peak();
  const double before = status_megabytes("VmRSS");
  for (int i = 0; i < runs; ++i) {
    m.mesh = WaterMesh();
    const double start = cpu_seconds();
    const Status status = reconstruct_surface(input, options, &m.mesh, &m.report);
    m.seconds = std::min(m.seconds, cpu_seconds() - start);
    if (i == 0) m.megabytes = status_megabytes("VmHWM") - before;
    if (!status.ok()) {
      std::fprintf(stderr, "%s\n", status.message.c_str());
      std::_Exit(2);
    }
  }
  return m;
}

void print_plain(const char* name, const test::WaterScene& scene, ReconstructionOptions options, int runs) {
  const Measured m = measure(scene, options, runs);
  const ReconstructionSeconds& s = m.report.seconds;
  std::printf(
      "%-8s %9zu particles  %7.2f CPU s  %6.0f MB  %8zu triangles  (last run, wall: blocks %.2f, field %.2f, "
      "mesh "
      "%.2f, vertices %.2f; %zu blocks)\n",
      name, scene.particles.size(), m.seconds, m.megabytes, m.mesh.triangles.size(), s.blocks, s.field,
      s.mesh, s.vertices, m.report.blocks);
}

test::WaterScene dam() {
  test::WaterScene scene;
  scene.spacing = 0.01;
  scene.add_water({Vec3::Zero(), Vec3::Constant(111 * scene.spacing)}, 0.2, 1);
  return scene;
}

test::WaterScene sheet() {
  test::WaterScene scene;
  scene.spacing = 0.0081;
  const double s = scene.spacing;
  test::Random random(2);
  for (int layer = 0; layer < 2; ++layer)
    for (int j = 0; j < 245; ++j)
      for (int i = 0; i < 245; ++i) {
        const double x = s * (i + 0.5), y = s * (j + 0.5);
        scene.particles.push_back(Vec3(x, y, 1 + test::waves(x, y, 0.05, 0.7) + s * layer) +
                                  0.2 * s * random.in_cube(1));
      }
  scene.add_water({Vec3(1, 1, 1.2), Vec3(1 + 8 * s, 1 + 8 * s, 1.2 + 57 * s)}, 0.2, 3);
  return scene;
}

/// A jet on a sagging cloth, and the water that lies in it.
test::WaterScene jet() {
  test::WaterScene scene;
  const double size = 0.5;
  const auto sag = [size](double x, double y) {
    return -0.12 * std::sin(3.14159265 * x / size) * std::sin(3.14159265 * y / size) +
           test::waves(x, y, 0.002, 0.11);
  };
  scene.add_sheet(56, [&](double u, double v) { return Vec3(size * u, size * v, sag(size * u, size * v)); });
  const Vec3 middle(0.5 * size, 0.5 * size, 0);
  scene.add_water({Vec3(0.05, 0.05, -0.13), Vec3(0.45, 0.45, 0.02)}, 0.2, 4, [&](const Vec3& p) {
    const double above = p.z() - sag(p.x(), p.y()), r = std::hypot(p.x() - middle.x(), p.y() - middle.y());
    return above > 0.001 && above < 0.021 && r < 0.165;
  });
  scene.add_water({Vec3(0.22, 0.22, -0.09), Vec3(0.28, 0.28, 0.3)}, 0.2, 5,
                  [&](const Vec3& p) { return std::hypot(p.x() - middle.x(), p.y() - middle.y()) < 0.02; });
  scene.push_off(0.2);
  return scene;
}

void print_contact(const char* name, const test::WaterScene& scene, double cell, int threads, int runs) {
  struct Mode {
    const char* name;
    ObstacleMode contact;
    double gap;
    int smoothing;
  };
  const double s = scene.spacing;
  double volume = 0;
  std::map<int, double> alone;  // by iterations of smoothing
  for (const Mode& mode :
       {Mode{"none", ObstacleMode::none, 0, 0}, Mode{"none, smooth 10", ObstacleMode::none, 0, 10},
        Mode{"reset", ObstacleMode::reset, 0, 0}, Mode{"reset 1 s", ObstacleMode::reset, 1, 0},
        Mode{"gap", ObstacleMode::gap, 0, 0}, Mode{"gap 0.1 s", ObstacleMode::gap, 0.1, 0},
        Mode{"gap 0.4 s", ObstacleMode::gap, 0.4, 0}, Mode{"touch", ObstacleMode::touch, 0, 0},
        Mode{"touch, smooth 10", ObstacleMode::touch, 0, 10},
        Mode{"overlap 0.2 s", ObstacleMode::overlap, 0.2, 0}}) {
    ReconstructionOptions options;
    options.spacing = s;
    options.cell = cell;
    options.contact = mode.contact;
    options.gap = mode.contact == ObstacleMode::overlap ? 0 : std::min(mode.gap, 1.0) * s;
    options.overlap_depth = mode.contact == ObstacleMode::overlap ? mode.gap * s : 0;
    options.smoothing_iterations = mode.smoothing;
    options.threads = threads;
    const Measured m = measure(scene, options, runs);
    if (mode.contact == ObstacleMode::none) {
      alone[mode.smoothing] = m.seconds;
      if (mode.smoothing == 0) volume = m.report.volume;
    }
    const MeshCheck check = check_mesh(m.mesh, scene.obstacles(), options.gap, threads);
    std::printf(
        "%-8s cell %.2f s  %-17s %7.3f CPU s (x %4.2f) %7zu triangles  volume %7.1f cm3 (%+5.1f %%)  %4zu "
        "pairs cut, "
        "%zu pieces within; %d rounds, %zu nodes cleared\n",
        name, cell, mode.name, m.seconds, m.seconds / alone[mode.smoothing], m.mesh.triangles.size(),
        1e6 * m.report.volume, 100 * (m.report.volume / volume - 1), check.intersecting_pairs,
        check.submerged_components, m.report.repair_rounds, m.report.nodes_cleared);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2, runs = argc > 3 ? std::atoi(argv[3]) : 3;
  const auto asked = [&](const char* name) { return what == name || what == "all"; };
  ReconstructionOptions options;
  options.threads = threads;
  if (asked("dam"))
    apart([&] {
      const test::WaterScene scene = dam();
      options.spacing = scene.spacing;
      print_plain("dam", scene, options, runs);
    });
  if (asked("sheet"))
    apart([&] {
      const test::WaterScene scene = sheet();
      options.spacing = scene.spacing;
      print_plain("sheet", scene, options, runs);
    });
  if (asked("jet"))
    apart([&] {
      const test::WaterScene scene = jet();
      std::printf("jet: %zu particles, %zu triangles of cloth\n", scene.particles.size(),
                  scene.triangles.size());
      for (double cell : {0.8, 0.5}) print_contact("jet", scene, cell, threads, runs);
    });
  if (asked("scenes"))
    apart([&] {
      for (double cell : {0.8, 0.5}) {
        print_contact("both", test::wavy_scene(true), cell, threads, runs);
        print_contact("above", test::wavy_scene(false), cell, threads, runs);
        print_contact("vee", test::vee_scene(), cell, threads, runs);
        print_contact("crumple", test::crumple_scene(), cell, threads, runs);
      }
    });
  return 0;
}
