// DAM(n): a cube of n³ particles collapses in a box of static triangles. Prints milliseconds per step, with
// the density error that was truly reached, measured on the positions at the start of each step.
//
// The fluid is that of a scene for comparison with SPlisHSPlasH: spacing s = 1/n, H = 2.15443469 s, dt =
// s/20, ν = 0.01, 0.1 % mean density error, at least 3 iterations of PCISPH and 2 of DFSPH.
// compare_splishsplash.py runs both in turn.
//
// use: dam_benchmark [n = 25] [threads = 2] [steps = 100] [pcisph | dfsph | both = both]; the figures are of
// the second half of the steps
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "oilskin/world.h"
#include "support/static_mesh.h"

using namespace oilskin;

namespace {

/// n³ particles in a corner. The peak of memory must contain no arrays of the caller.
bool add_cube(int n, World& world) {
  const double s = 1.0 / n;
  std::vector<Vec3> x;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) x.push_back(s * Vec3(i + 1.15, j + 1.15, k + 1.15));
  const std::vector<Vec3> v(x.size(), Vec3::Zero());
  return world.add_particles(x, v).ok();
}

int run(int n, int threads, int steps, PressureSolver solver) {
  const double s = 1.0 / n;
  const bool dfsph = solver == PressureSolver::dfsph;

  FluidSettings fluid;
  fluid.spacing = s;
  fluid.support_ratio = 2.15443469;
  fluid.viscosity = 0.01;
  fluid.xsph_rate = 0;
  fluid.solver = solver;
  fluid.boundary = BoundaryModel::contact_only;
  fluid.min_iterations = dfsph ? 2 : 3;
  fluid.max_iterations = 100;
  WorldSettings settings;
  settings.threads = threads;
  settings.kill_box = {Vec3(-1, -1, -1), Vec3(4, 4, 4)};
  World world(settings, fluid);

  test::StaticMesh walls;
  walls.add_box({Vec3(0, 0, 0), Vec3(3, 2, (n + 1.3) * s)}, 0.25);
  SurfaceSettings surface;
  surface.thickness = 0.5 * s;
  if (Status status = world.attach(walls, surface, nullptr); !status.ok()) {
    std::fprintf(stderr, "%s\n", status.message.c_str());
    return 2;
  }
  if (!add_cube(n, world)) return 2;

  StageSeconds seconds;
  double wall = 0, iterations = 0, divergence_iterations = 0, error_sum = 0, error_max = 0;
  int counted = 0;
  for (int k = 0; k < steps; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    const StepReport& r = world.step(s / 20);
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!r.status.ok()) return 2;
    if (k < steps / 2) continue;
    ++counted;
    wall += elapsed;
    seconds += r.seconds;
    iterations += r.fluid.iterations;
    divergence_iterations += r.fluid.divergence_iterations;
    double sum = 0;
    for (double density : world.densities()) {
      const double e = std::max(0.0, density / fluid.rest_density - 1);
      sum += e;
      error_max = std::max(error_max, e);
    }
    error_sum += sum / static_cast<double>(world.particle_count());
  }
  const double ms = 1e3 / counted;
  const double contact = seconds.gather + seconds.proximity + seconds.impulses + seconds.ccd + seconds.zones;
  std::printf("DAM(%d), %s: %zu particles, %d threads, steps %d to %d\n", n, dfsph ? "DFSPH" : "PCISPH",
              world.particle_count(), threads, steps / 2 + 1, steps);
  std::printf(
      "  whole step %.2f ms; fluid %.2f ms (neighbours %.2f, pressure %.2f, other %.2f); contact with walls "
      "%.2f ms\n",
      wall * ms, (seconds.neighbours + seconds.pressure + seconds.other_fluid) * ms, seconds.neighbours * ms,
      seconds.pressure * ms, seconds.other_fluid * ms, contact * ms);
  std::printf("  %.2f iterations per step, %.2f of divergence; density error mean %.4f %%, max %.2f %%\n",
              iterations / counted, divergence_iterations / counted, 100 * error_sum / counted,
              100 * error_max);
  std::printf("  %.3g particle·steps/s\n", static_cast<double>(world.particle_count()) * counted / wall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 25;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
  const int steps = argc > 3 ? std::atoi(argv[3]) : 100;
  const std::string solver = argc > 4 ? argv[4] : "both";
  if (solver != "dfsph" && run(n, threads, steps, PressureSolver::pcisph) != 0) return 2;
  if (solver != "pcisph" && run(n, threads, steps, PressureSolver::dfsph) != 0) return 2;
  return 0;
}
