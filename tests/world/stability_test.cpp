// What is integrated explicitly stays stable: the step is cut, or the viscosity limited, and a flag says so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

FluidSettings thick(double viscosity, int max_substeps, PressureSolver solver = PressureSolver::pcisph) {
  FluidSettings f;
  f.viscosity = viscosity;
  f.max_substeps = max_substeps;
  f.solver = solver;
  f.boundary = BoundaryModel::contact_only;
  return f;
}

/// A step of water at rest.
StepReport step_of(const FluidSettings& fluid, double dt) {
  World w(box(1), fluid);
  add_block(w, 4, Vec3::Zero(), Vec3::Zero());
  return w.step(dt);
}

TEST(Viscosity, cuts_the_step_as_often_as_it_needs) {
  const double limit = 0.035 * 0.01 * 0.01;  // [m²], of ν dt
  for (const PressureSolver solver : {PressureSolver::pcisph, PressureSolver::dfsph, PressureSolver::mcg03})
    for (const double dt : {1e-4, 7e-4, 4e-3})
      for (const double needed : {0.7, 1.2, 4.9, 7.3}) {
        const double parts = std::ceil(needed);
        const StepReport r = step_of(thick(needed * limit / dt, 8, solver), dt);
        EXPECT_GE(r.substeps, parts);
        EXPECT_LE(r.substeps, parts + 1) << "with what XSPH adds";
        EXPECT_LE(r.substeps_needed, r.substeps);
        EXPECT_EQ(r.flags, 0u);
        EXPECT_TRUE(r.messages.empty());
      }
}

TEST(Viscosity, is_limited_where_the_step_may_not_be_cut_and_a_message_has_the_numbers) {
  const StepReport r = step_of(thick(0.1, 8), 1e-3);
  EXPECT_EQ(r.substeps, 8);
  EXPECT_EQ(r.substeps_needed, 29);
  EXPECT_EQ(r.flags, static_cast<std::uint32_t>(flag_viscosity_limited));
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_EQ(r.messages[0],
            "fluid.viscosity 0.1 m²/s at dt 0.001 s needs 29 fluid sub-steps; max_substeps is 8, so 0.028 "
            "m²/s was applied");
  EXPECT_EQ(flag_texts(r.flags).size(), 1u);
  World empty(box(1), thick(0.1, 1));
  EXPECT_EQ(empty.step(1e-3).flags, 0u) << "no water, no flag";
}

double kinetic(const World& w) {
  double sum = 0;
  for (const Vec3& v : w.velocities()) sum += v.squaredNorm();
  return sum;
}

/// Water in slight disorder with random velocities, in the air.
void expect_no_energy(const FluidSettings& fluid, double dt, double jitter, Random& random) {
  World w(box(1), fluid);
  std::vector<Vec3> x, v;
  for (int i = 0; i < 512; ++i) {
    const int column = i % 8, row = i / 8 % 8, layer = i / 64;
    x.push_back(0.005 * Vec3(column, row, layer) + random.in_cube(jitter * 0.005));
    v.push_back(random.in_cube(0.1));
  }
  ASSERT_TRUE(w.add_particles(x, v, nullptr).ok());
  const double start = kinetic(w);
  for (int k = 0; k < 12; ++k) {
    const StepReport& r = w.step(dt);
    EXPECT_EQ((r.flags & flag_viscosity_limited) != 0, r.substeps_needed > r.substeps);
    EXPECT_LE(kinetic(w), start) << "viscosity " << fluid.viscosity << ", dt " << dt << ", sub-steps "
                                 << fluid.max_substeps << ", solver " << static_cast<int>(fluid.solver);
  }
  EXPECT_EQ(w.particle_count(), 512u);
}

TEST(Viscosity, of_any_size_makes_no_energy_at_any_step) {
  Random random(3);
  for (const PressureSolver solver : {PressureSolver::pcisph, PressureSolver::dfsph, PressureSolver::mcg03})
    for (const int maximum : {1, 8})
      for (int k = 0; k < 8; ++k) {
        FluidSettings fluid = thick(random.log_uniform(3e-3, 10), maximum, solver);
        fluid.xsph_rate = k % 3 == 0 ? random.log_uniform(10, 1e4) : 10;
        fluid.xsph_strain = k % 2;
        expect_no_energy(fluid, random.log_uniform(1e-3, 1e-2), 0.02, random);
      }
}

/// A block at `packing` spacings between particles, each with a random velocity.
void expect_friction_to_damp(const FluidSettings& fluid, double packing, double dt, Random& random) {
  World w(box(1), fluid);
  std::vector<Vec3> x, v;
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 512; ++i) {
    const int column = i % 8, row = i / 8 % 8, layer = i / 64;
    x.push_back(packing * fluid.spacing * Vec3(column, row, layer));
    v.push_back(random.in_cube(0.01));
    before += v.back();
  }
  ASSERT_TRUE(w.add_particles(x, v, nullptr).ok());
  double energy = kinetic(w);
  for (int k = 0; k < 4; ++k) {
    EXPECT_LE(w.step(dt).substeps, 1);
    EXPECT_LE(kinetic(w), energy) << "packing " << packing << ", dt " << dt << ", step " << k;
    energy = kinetic(w);
  }
  Vec3 after = Vec3::Zero();
  for (const Vec3& velocity : w.velocities()) after += velocity;
  EXPECT_LE((after - before).norm(), 1e-5 * before.norm());
}

TEST(Smoothing, of_clusters_that_are_too_dense_makes_no_energy) {
  Random random(5);
  FluidSettings fluid = thick(0, 1, PressureSolver::mcg03);
  fluid.stiffness = 1e-12;  // only the friction acts
  for (const double rate : {1.0, 40.0, 1e4})
    for (const double packing : {1.0, 0.7, 0.5, 0.35})
      for (const double dt : {1e-3, 1.0 / 60}) {
        fluid.xsph_rate = rate;
        fluid.xsph_strain = 1;
        fluid.viscosity = rate > 1 ? 0 : 1e-3;
        expect_friction_to_damp(fluid, packing, dt, random);
      }
}

TEST(Smoothing, that_is_not_named_follows_from_spacing_and_gravity) {
  const auto smoothing = [](const FluidSettings& s) {
    const World w(box(1, Vec3(0, -9.81, 0)), s);
    return std::pair(*w.fluid_settings().xsph_rate, *w.fluid_settings().xsph_strain);
  };
  FluidSettings s;
  EXPECT_EQ(smoothing(s), std::pair(default_xsph_rate(s.spacing, 9.81), 1.0));
  s.xsph_rate = 10;
  EXPECT_EQ(smoothing(s), std::pair(10.0, 0.0)) << "who names a rate gets that rate";
  s.xsph_strain = 0.5;
  EXPECT_EQ(smoothing(s), std::pair(10.0, 0.5));
  s.xsph_rate.reset();
  EXPECT_EQ(smoothing(s), std::pair(default_xsph_rate(s.spacing, 9.81), 0.5));
  s.xsph_strain = -0.1;
  EXPECT_NE(World(box(1), s).status().message.find("fluid.xsph_strain"), std::string::npos);
}

TEST(Settings, boundary_terms_need_a_pressure_solver_that_has_them) {
  FluidSettings s;
  s.solver = PressureSolver::mcg03;
  s.boundary = BoundaryModel::mirrored;
  EXPECT_FALSE(s.validate().ok());
  EXPECT_NE(s.validate().message.find("boundary"), std::string::npos);
}

TEST(StateEquation, flags_sound_that_is_too_fast) {
  FluidSettings gas = thick(0, 1, PressureSolver::mcg03);
  gas.stiffness = 100;  // 10 m/s
  EXPECT_EQ(step_of(gas, 0.39e-3).flags, 0u);
  const StepReport r = step_of(gas, 0.41e-3);
  EXPECT_EQ(r.flags, static_cast<std::uint32_t>(flag_sound_too_fast));
  EXPECT_EQ(r.substeps_needed, 2);
  gas.max_substeps = 3;
  EXPECT_EQ(step_of(gas, 0.41e-3).substeps, 2);
  EXPECT_EQ(step_of(gas, 0.41e-3).flags, 0u);
  EXPECT_EQ(step_of(gas, 2e-3).flags, static_cast<std::uint32_t>(flag_sound_too_fast));
}

/// At rest on a floor, deep for the step.
TEST(LoadedWater, that_needs_more_substeps_than_allowed_is_flagged_with_their_number) {
  FluidSettings fluid = of_spacing(0.002);
  WorldSettings settings = box(1, Vec3(0, -9.81, 0));
  for (const auto& [dt, is_limited] : {std::pair<double, bool>{1.0 / 30, true}, {1.0 / 120, false}}) {
    World w(settings, fluid);
    StaticMesh tank;
    tank.add_box({Vec3(-0.006, 0, -0.006), Vec3(0.006, 0.08, 0.006)}, 1);
    ASSERT_TRUE(w.attach(tank, sheet_settings(0.0004), nullptr).ok());
    std::vector<Vec3> x;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 30; ++j)
        for (int k = 0; k < 6; ++k) x.push_back(0.002 * Vec3(i - 2.5, j + 0.5, k - 2.5));
    ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
    bool flagged = false;
    for (int k = 0; k < 5; ++k) {
      const StepReport r = w.step(dt);
      if ((r.flags & flag_load_limited) == 0) continue;
      flagged = true;
      EXPECT_EQ(r.substeps, 8);
      EXPECT_GT(r.substeps_needed, 1.2 * 8);
      EXPECT_TRUE(std::any_of(r.messages.begin(), r.messages.end(), [](const std::string& m) {
        return m.find("the weight of the water") != std::string::npos;
      }));
    }
    EXPECT_EQ(flagged, is_limited) << dt;
  }
}

}  // namespace
}  // namespace oilskin::test
