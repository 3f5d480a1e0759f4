// How many sub-steps a step has, and the step that the world suggests.
#include <gtest/gtest.h>

#include <cmath>

#include "support/world_helpers.h"
#include "world/driven_sheet.h"
#include "world/substeps.h"

namespace oilskin::test {
namespace {

TEST(SubstepCount, follows_the_rule) {
  world::Speeds s;
  EXPECT_EQ(substep_count(s, 1, 0.002, 10), 1);
  s.fluid = 4;
  EXPECT_EQ(substep_count(s, 1e-3, 0.002, 10), 2);
  EXPECT_EQ(substep_count(s, 1.001e-3, 0.002, 10), 3);
  EXPECT_EQ(substep_count(s, 1, 0.002, 10), 10);
  s.gravity = 10;
  EXPECT_EQ(substep_count(s, 0.2, 0.25, 10), 5) << "0.2 s at 4 + 0.2 · 10 m/s";
  s.change = 3000;
  EXPECT_EQ(substep_count(s, 2e-3, 0.002, 10), 6) << "4 m/s, and 3000 m/s² once more: 0.387 ms";
  s.surfaces = 1e300;
  EXPECT_EQ(substep_count(s, 1e300, 1e-6, 1000), 1000);
}

TEST(SubstepCount, the_longest_step_needs_one) {
  for (double gravity : {0.0, 9.81})
    for (double v : {0.0, 1e-3, 2.0, 1e6})
      for (double wall : {0.0, 3.0}) {
        const world::Speeds s{v, gravity, wall};
        const double dt = world::longest_step(s, 0.002);
        if (v + gravity + wall == 0) {
          EXPECT_TRUE(std::isinf(dt));
          continue;
        }
        EXPECT_EQ(substep_count(s, dt * (1 - 1e-12), 0.002, 10), 1);
        EXPECT_EQ(substep_count(s, dt * (1 + 1e-9), 0.002, 10), 2);
      }
}

double suggested(const FluidSettings& fluid, const Vec3& velocity, double gravity, double largest = 1) {
  World w(box(1, Vec3(0, -gravity, 0)), fluid);
  add_block(w, 1, Vec3::Zero(), velocity);
  return w.suggested_dt(largest);
}

TEST(SuggestedDt, is_the_smallest_of_its_limits) {
  EXPECT_EQ(World(box(1)).suggested_dt(0.25), 0.25) << "nothing there";
  EXPECT_EQ(suggested(cut_into(1), Vec3::Zero(), 0), 1);
  EXPECT_NEAR(suggested(cut_into(1), Vec3(0, 2, 0), 0), 0.4 * 0.005 / 2, 1e-15);
  EXPECT_NEAR(suggested(cut_into(3, 0.5), Vec3(0, 2, 0), 0), 3 * 0.5 * 0.005 / 2, 1e-15);
  const double falling = suggested(cut_into(1), Vec3(0, -2, 0), 9.81);
  EXPECT_NEAR(falling * (2 + 9.81 * falling), 0.4 * 0.005, 1e-15);
  EXPECT_EQ(suggested(cut_into(1), Vec3(0, 2, 0), 0, 1e-4), 1e-4);
  FluidSettings honey = cut_into(1);
  honey.viscosity = 1;
  honey.xsph_rate = 0;
  EXPECT_NEAR(suggested(honey, Vec3::Zero(), 0), 0.035 * 0.01 * 0.01, 1e-15);
  honey.max_substeps = 4;
  EXPECT_NEAR(suggested(honey, Vec3::Zero(), 0), 4 * 0.035 * 0.01 * 0.01, 1e-15);
  honey.xsph_rate = 1e9;  // the first parts of both operators are damped at once: half of it is left
  EXPECT_NEAR(suggested(honey, Vec3::Zero(), 0), 2 * 0.035 * 0.01 * 0.01, 1e-15);
  FluidSettings gas = cut_into(1);
  gas.solver = PressureSolver::mcg03;
  gas.boundary = BoundaryModel::contact_only;
  EXPECT_NEAR(suggested(gas, Vec3(0, 0.1, 0), 0), 0.4 * 0.01 / 2.1, 1e-15);
  gas.max_substeps = 2;
  EXPECT_NEAR(suggested(gas, Vec3(0, 0.1, 0), 0), 2 * 0.4 * 0.01 / 2.1, 1e-15);
}

TEST(SuggestedDt, takes_the_emitters_of_the_next_step_into_account) {
  World w(box(1), cut_into(1));
  DiscEmitter nozzle;
  nozzle.speed = 4;
  nozzle.start = 0.5;
  nozzle.stop = 0.6;
  ASSERT_TRUE(w.add_emitter(nozzle).ok());
  BoxEmitter block;
  block.box = {Vec3::Zero(), Vec3::Constant(0.02)};
  block.velocity = Vec3(1, 0, 0);
  ASSERT_TRUE(w.add_emitter(block).ok());
  EXPECT_NEAR(w.suggested_dt(0.01), 0.002, 1e-15) << "the block starts, the nozzle waits";
  EXPECT_NEAR(w.suggested_dt(0.51), 0.0005, 1e-15);
  EXPECT_EQ(w.particle_count(), 0u) << "a question";
  w.step(0.001);
  EXPECT_EQ(w.report().emitted, 64u);
}

TEST(SuggestedDt, knows_accelerations_and_surfaces_from_the_last_step) {
  FluidSettings settings = cut_into(1);
  for (const BoundaryModel boundary : {BoundaryModel::contact_only, BoundaryModel::mirrored}) {
    settings.boundary = boundary;
    World falls(box(1, Vec3(0, -9.81, 0)), settings);
    std::vector<Vec3> tower;  // of particles that do not feel each other
    for (int k = 0; k <= 20; ++k) tower.emplace_back(0, 0.01 * k, 0);
    ASSERT_TRUE(falls.add_particles(tower, std::vector<Vec3>(tower.size(), Vec3::Zero())).ok());
    falls.step(1e-3);
    const double limit = boundary == BoundaryModel::mirrored ? 0.7 * std::sqrt(0.005 / (41 * 9.81))  // (F.55)
                                                             : 0.25 * std::sqrt(0.01 / 9.81);
    EXPECT_NEAR(falls.suggested_dt(1), limit, 1e-6);
  }

  World w(box(1), cut_into(1));
  Driven sheet(0.1);
  ASSERT_TRUE(w.attach(sheet, sheet_settings(), nullptr).ok());
  add_block(w, 3, Vec3(0, 0.012, 0), Vec3::Zero());
  EXPECT_EQ(w.suggested_dt(1), 1);
  sheet.move(Vec3(0, 0.004, 0));
  w.step(1e-3);
  EXPECT_NEAR(w.suggested_dt(1), 0.4 * 0.005 / 4, 1e-8);
}

TEST(SuggestedDt, is_never_zero_for_invalid_particles_or_settings) {
  World w(box(1));
  add_block(w, 2, Vec3::Zero(), Vec3::Zero());
  std::vector<Vec3> dv(8, Vec3::Zero());
  dv[1].x() = 1e300;
  dv[2].y() = std::nan("");
  ASSERT_TRUE(w.add_velocities(dv).ok());
  EXPECT_EQ(w.suggested_dt(0.5), 0.5) << "they are quarantined first";
  EXPECT_EQ(w.suggested_dt(0), 0);
  FluidSettings bad;
  bad.cfl = 0;
  EXPECT_EQ(World(box(1), bad).suggested_dt(0.5), 0.5);
}

// A step that takes no notice of them lets 16 layers fall through each other.
TEST(Substeps, of_the_step_in_which_a_box_starts_are_those_of_its_water) {
  World starts(box(1, Vec3(0, -9.81, 0)), cut_into(8)), lives(box(1, Vec3(0, -9.81, 0)), cut_into(8));
  constexpr int layers = 16;
  const double dx = lives.fluid_settings().spacing;
  BoxEmitter water;
  water.box = {Vec3::Constant(-dx / 2), Vec3::Constant((layers - 0.5) * dx)};
  ASSERT_TRUE(starts.add_emitter(water).ok());
  add_block(lives, layers, Vec3::Zero(), Vec3::Zero());
  EXPECT_NEAR(starts.suggested_dt(1), lives.suggested_dt(1), 1e-12);
  const int expected = lives.step(0.01).substeps;
  EXPECT_GT(expected, 1);
  EXPECT_EQ(starts.step(0.01).substeps, expected);
  EXPECT_EQ(starts.particle_count(), lives.particle_count());
}

}  // namespace
}  // namespace oilskin::test
