// Slopes of the kernel that are stored, and slopes that loops compute again.
#include <gtest/gtest.h>

#include "support/random.h"
#include "support/surface_of.h"
#include "tank.h"

namespace oilskin::fluid {
namespace {

FluidSettings settings_of(PressureSolver solver, BoundaryModel boundary) {
  FluidSettings settings = water();
  settings.solver = solver;
  settings.boundary = boundary;
  return settings;
}

/// Velocities after some steps of a block on a floor. Slopes are stored for `most` particles.
std::vector<Vec3> velocities(const FluidSettings& settings, std::size_t most) {
  Tank tank(settings, 2);
  tank.solver.store_slopes_of(most);
  test::StaticMesh floor;
  floor.add_rectangle(Vec3(-0.02, 0, -0.02), Vec3(0.14, 0, 0), Vec3(0, 0, 0.14), 7, 7);
  SurfaceMotion surface = test::surface_of(floor);
  SurfaceMotion* surfaces[] = {&surface};
  const MeshTopology topology(surface.triangles, surface.x_t0.size());
  const MeshTopology* topologies[] = {&topology};
  test::Random random(5);
  const auto shaken = [&](int k) { return settings.spacing * (k + 0.5 + 0.1 * (random.uniform() - 0.5)); };
  for (int c = 0; c < 18; ++c)
    for (int b = 0; b < 10; ++b)
      for (int a = 0; a < 18; ++a) tank.add(Vec3(shaken(a), shaken(b), shaken(c)), Vec3(0, -0.5, 0));
  Particles& particles = tank.particles;
  const double dt = 5e-4;
  for (int step = 0; step < 4; ++step) {
    tank.solver.prepare(particles, tank.seconds);
    tank.solver.apply_surfaces(dt, dt, tank.gravity, particles, surfaces, topologies, {}, tank.seconds);
    tank.solver.propose(dt, tank.gravity, particles, {}, {}, particles.velocity, tank.report, tank.seconds);
    for (std::size_t i = 0; i < particles.size(); ++i) particles.position[i] += dt * particles.velocity[i];
  }
  return particles.velocity;
}

TEST(Slopes, have_the_same_bits_stored_and_computed) {
  for (const PressureSolver solver : {PressureSolver::mcg03, PressureSolver::pcisph, PressureSolver::dfsph}) {
    const FluidSettings alone = settings_of(solver, BoundaryModel::contact_only);
    const std::vector<Vec3> stored = velocities(alone, SIZE_MAX);
    EXPECT_EQ(velocities(alone, 0), stored);
    EXPECT_EQ(velocities(alone, 1500), stored) << "some of the chunks of 512";
  }
}

/// Images of neighbours change slopes at walls: those are stored in any case.
TEST(Slopes, are_stored_at_walls) {
  for (const PressureSolver solver : {PressureSolver::pcisph, PressureSolver::dfsph}) {
    const FluidSettings at_walls = settings_of(solver, BoundaryModel::mirrored);
    const std::vector<Vec3> stored = velocities(at_walls, SIZE_MAX);
    EXPECT_NE(stored, velocities(settings_of(solver, BoundaryModel::contact_only), SIZE_MAX))
        << "the floor acts";
    EXPECT_EQ(velocities(at_walls, 0), stored);
    EXPECT_EQ(velocities(at_walls, 1500), stored);
  }
}

}  // namespace
}  // namespace oilskin::fluid
