// Hard case 46: threads.
#include <gtest/gtest.h>

#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "support/busy_scene.h"

namespace oilskin::test {
namespace {

using namespace water;

TEST(HardFluid, threads_do_not_change_a_bit) {
  HardCase c("46", "1, 2 and 16 threads; occlusion, mirrored walls, DFSPH, sub-steps, emitters");
  struct Mode {
    PressureSolver solver;
    bool mirrored, occlusion;
    int substeps;
  };
  std::uint64_t runs = 0, different = 0;
  std::size_t particles = 0;
  for (const Mode& mode :
       {Mode{PressureSolver::pcisph, true, true, 1}, Mode{PressureSolver::dfsph, true, true, 1},
        Mode{PressureSolver::dfsph, false, false, 6}, Mode{PressureSolver::pcisph, true, true, 6},
        Mode{PressureSolver::mcg03, false, true, 3}}) {
    std::vector<std::uint64_t> hashes[3];
    for (int k = 0; k < 3; ++k) {
      constexpr int counts[] = {1, 2, 16};
      FluidSettings fluid = solver_of(mode.solver, mode.mirrored);
      fluid.occlusion = mode.occlusion;
      fluid.max_substeps = mode.substeps;
      BusyScene<float> scene(busy_world(counts[k]), fluid);
      scene.add_emitters();
      fill(scene.world, lattice(12, 8, 12, Vec3(-0.0326, 0.07, -0.0324)), Vec3(0, -2, 0));
      for (int step = 0; step < 30; ++step) {
        ASSERT_TRUE(scene.step(step).status.ok());
        hashes[k].push_back(scene.world.state_hash());
      }
      particles = scene.world.particle_count();
      ++runs;
    }
    for (const auto& each : hashes) different += each != hashes[0];
  }
  c.above("particles", static_cast<double>(particles), 1100);
  c.note("runs", runs);
  c.equal("runs with other bits than on one thread", different, 0);
}

}  // namespace
}  // namespace oilskin::test
