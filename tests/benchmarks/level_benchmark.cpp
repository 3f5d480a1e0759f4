// What a static level costs a step: the same water, with a level of many triangles of which it touches one
// corner, and with only that corner. User-CPU time of each stage, and their difference.
//
// use: level_benchmark [cells along an edge = 316] [particles along an edge = 11] [steps = 60] [threads = 1]
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>

#include "oilskin/world.h"
#include "support/static_mesh.h"

using namespace oilskin;

namespace {

double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

/// A ground of cells of 3 cm with hills of some cm, the water in a hollow in one corner.
struct Level {
  test::StaticMesh ground;
  World world;
  double seconds = 0;
  StageSeconds stages;

  Level(int cells, int edge, int threads, test::StaticMesh::Changes changes) : world(settings(threads)) {
    constexpr double cell = 0.03;
    const auto n = static_cast<std::uint32_t>(cells);
    ground.add_rectangle(Vec3::Zero(), Vec3(0, 0, cell * cells), Vec3(cell * cells, 0, 0), n, n);
    for (Vec3& x : ground.nodes) x.y() = 0.05 * (std::cos(9 * (x.x() - 0.3)) * std::cos(9 * (x.z() - 0.3)));
    for (Vec3& x : ground.nodes) x.y() = -x.y();
    ground.changes = changes;
    if (!world.attach(ground, {}, nullptr).ok()) std::abort();
    std::vector<Vec3> x;
    for (int i = 0; i < edge; ++i)
      for (int j = 0; j < edge; ++j)
        for (int k = 0; k < edge; ++k) x.push_back(Vec3(0.25, -0.045, 0.25) + 0.01 * Vec3(i, j, k));
    if (!world.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok()) std::abort();
  }
  static WorldSettings settings(int threads) {
    WorldSettings s;
    s.threads = threads;
    s.kill_box = {Vec3::Constant(-1), Vec3::Constant(20)};
    return s;
  }
  void step() {
    const double before = user_seconds();
    const StepReport& report = world.step(2e-3);
    seconds += user_seconds() - before;
    stages += report.seconds;
  }
};

void print(const char* name, const Level& level, int steps) {
  const double ms = 1e3 / steps;
  const StageSeconds& s = level.stages;
  std::printf("%-22s %9zu %8zu %9.3f %8.3f %9.3f %9.3f %8.3f %8.3f %8.3f %8.3f\n", name,
              level.ground.triangles.size(), level.world.particle_count(), ms * level.seconds, ms * s.gather,
              ms * s.proximity, ms * s.occlusion, ms * s.boundary, ms * s.impulses, ms * s.pressure,
              ms * s.other_fluid);
}

}  // namespace

int main(int argc, char** argv) {
  const int cells = argc > 1 ? std::atoi(argv[1]) : 316, edge = argc > 2 ? std::atoi(argv[2]) : 11;
  const int steps = argc > 3 ? std::atoi(argv[3]) : 60, threads = argc > 4 ? std::atoi(argv[4]) : 1;
  using Changes = test::StaticMesh::Changes;
  Level corner(30, edge, threads, Changes::never), level(cells, edge, threads, Changes::never),
      unnumbered(cells, edge, threads, Changes::unknown);
  const std::initializer_list<Level*> all = {&corner, &level, &unnumbered};
  for (Level* l : all)
    for (int k = 0; k < 5; ++k) l->world.step(2e-3);
  for (int k = 0; k < steps; ++k)
    for (Level* l : all) l->step();
  std::printf(
      "level                  triangles particles CPU ms a step  gather proximity occlusion boundary "
      "impulses "
      "pressure other\n");
  print("corner", corner, steps);
  print("whole", level, steps);
  print("whole, no revision", unnumbered, steps);
  std::printf("the whole level costs %.3f ms a step more than its corner; states %s\n",
              1e3 / steps * (level.seconds - corner.seconds),
              level.world.state_hash() == unnumbered.world.state_hash() ? "equal" : "DIFFER");
  return 0;
}
