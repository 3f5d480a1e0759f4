// Emitters that start water below other water do work against its weight (F.76).
#include <gtest/gtest.h>

#include "support/static_mesh.h"
#include "support/world_helpers.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

constexpr double dx = 0.006, g = 9.81;

FluidSettings fluid_of(PressureSolver solver, BoundaryModel boundary = BoundaryModel::mirrored) {
  FluidSettings s;
  s.spacing = dx;
  s.solver = solver;
  s.boundary = boundary;
  s.xsph_rate = 0;
  s.viscosity = 0;
  return s;
}

/// A tank of 16 × 16 spacings, filled 12 spacings deep. `up` is a unit axis.
struct Tank {
  Tank(PressureSolver solver, const Vec3& up) : world(box(1, -g * up), fluid_of(solver)) {
    const Vec3 x = up.cross(Vec3(0.6, 0, 0.8)).normalized(), z = x.cross(up);
    const Vec3 corner = -8 * dx * (x + z);
    const Vec3 u = 16 * dx * x, w = 16 * dx * z, height = 24 * dx * up;
    mesh.add_rectangle(corner, w, u);
    for (const Vec3& at : {corner, Vec3(corner + w)}) mesh.add_rectangle(at, u, height);
    for (const Vec3& at : {corner, Vec3(corner + u)}) mesh.add_rectangle(at, w, height);
    EXPECT_TRUE(world.attach(mesh, sheet_settings(), nullptr).ok());
    std::vector<Vec3> points;
    for (int i = 0; i < 16; ++i)
      for (int j = 0; j < 12; ++j)
        for (int k = 0; k < 16; ++k)
          points.push_back(corner + dx * ((i + 0.5) * x + (j + 0.5) * up + (k + 0.5) * z));
    std::uint64_t blocked = 0;
    EXPECT_TRUE(world.add_particles(points, std::vector<Vec3>(points.size(), Vec3::Zero()), &blocked).ok());
    EXPECT_EQ(blocked, 0u);
  }

  StaticMesh mesh;
  World world;
};

DiscEmitter nozzle_at(const Vec3& center, const Vec3& direction, double speed) {
  DiscEmitter e;
  e.center = center;
  e.direction = direction;
  e.speed = speed;
  e.radius = 3 * dx;
  return e;
}

struct Submerged {
  PressureSolver solver;
  Vec3 up;
  double speed;  // upward; below 0 the nozzle points down
};

class WorkOfStarts : public ::testing::TestWithParam<Submerged> {};

TEST_P(WorkOfStarts, of_a_nozzle_under_water_is_its_flow_times_the_head) {
  const auto [solver, up, speed] = GetParam();
  Tank tank(solver, up);
  World& w = tank.world;
  for (int k = 0; k < 50; ++k) w.step(0.001);
  const double made_before = w.report().energy.made;
  EXPECT_NEAR(w.report().energy.work_outside, 0, 1e-12);
  const double depth = 7 * dx;
  EmitterId id;
  ASSERT_TRUE(w.add_emitter(nozzle_at(5 * dx * up, speed > 0 ? up : Vec3(-up), std::abs(speed)), &id).ok());
  for (int k = 0; k < 150; ++k) w.step(0.001);
  const double mass = static_cast<double>(w.emitter(id)->particles) * w.particle_mass();
  const EnergyReport& e = w.report().energy;
  ASSERT_GT(mass, 0.005);
  EXPECT_NEAR(e.work_outside, mass * g * depth, 0.35 * mass * g * depth);
  // Space for a layer is made within a step, faster than a pump would: that is made, but not the work of it.
  EXPECT_LE(e.made - made_before, 0.25 * mass * g * depth);
}

const Vec3 tilted = Vec3(1, 3, -2).normalized();

INSTANTIATE_TEST_SUITE_P(Nozzles, WorkOfStarts,
                         ::testing::Values(Submerged{PressureSolver::dfsph, Vec3::UnitY(), 0.3},
                                           Submerged{PressureSolver::dfsph, tilted, 1.0},
                                           Submerged{PressureSolver::dfsph, tilted, -1.0},
                                           Submerged{PressureSolver::pcisph, Vec3::UnitY(), 0.5},
                                           Submerged{PressureSolver::pcisph, tilted, -0.5}));

TEST(WorkOfStarts, of_a_fountain_is_none) {
  for (const PressureSolver solver : {PressureSolver::dfsph, PressureSolver::pcisph}) {
    World w(box(1, Vec3(0, -g, 0)), fluid_of(solver));
    EmitterId id;
    ASSERT_TRUE(w.add_emitter(nozzle_at(Vec3::Zero(), Vec3(0.5, 1, 0).normalized(), 2), &id).ok());
    for (int k = 0; k < 150; ++k) w.step(0.001);
    const EnergyReport& e = w.report().energy;
    ASSERT_GT(w.emitter(id)->particles, 500u);
    EXPECT_LE(e.work_outside, 0.01 * e.entered_kinetic);
    EXPECT_LE(e.made, 0.01 * e.scale);
  }
}

TEST(WorkOfStarts, is_none_without_gravity_or_water) {
  World w(box(1, Vec3::Zero()), fluid_of(PressureSolver::dfsph));
  std::vector<Vec3> points;
  for (int i = 0; i < 1000; ++i) points.push_back(dx * Vec3(i % 10 - 4.5, i / 10 % 10 - 4.5, i / 100 - 4.5));
  std::uint64_t blocked = 0;
  ASSERT_TRUE(w.add_particles(points, std::vector<Vec3>(1000, Vec3::Zero()), &blocked).ok());
  ASSERT_TRUE(w.add_emitter(nozzle_at(Vec3::Zero(), Vec3::UnitX(), 1)).ok());
  for (int k = 0; k < 20; ++k) w.step(0.001);
  ASSERT_GT(w.particle_count(), 1000u);
  EXPECT_NEAR(w.report().energy.work_outside, 0, 1e-12);
}

}  // namespace
}  // namespace oilskin::test
