// Hard cases 3, 10, 16, 48 of the fluid: coincident particles, long steps, crumpled layers, gravity.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/cloth_scene.h"
#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

using namespace water;

TEST(HardFluid, coincident_particles_get_finite_forces) {
  HardCase c("3", "2 and 1000 particles in one point over a sheet, three solvers");
  double speed = 0, density = 0;
  for (PressureSolver solver : all_solvers)
    for (int count : {2, 1000}) {
      ClothSetup setup;
      setup.fluid = solver_of(solver, solver != PressureSolver::mcg03);
      setup.pinned = true;
      const auto make = [&](int threads) {
        return std::make_unique<ClothScene<double>>(setup, threads, [&](ClothScene<double>& s) {
          fill(s.world(), std::vector<Vec3>(static_cast<std::size_t>(count), Vec3(0.0011, 0.003, 0.0007)));
        });
      };
      const Found found = run_checked(make, count == 2 ? 50 : 4, 1e-3);
      speed = std::max(speed, found.speed);
      const auto scene = make(1);
      scene->world().step(1e-3);
      EXPECT_EQ(scene->world().particle_count(), static_cast<std::size_t>(count));
      density = std::max(density, max_density(scene->world()));
    }
  c.above("largest density [ρ0]", density, 100);
  // They do not push each other, and walls push what is far too dense softly.
  c.below("largest speed [m/s]", speed, 50);
}

TEST(HardFluid, steps_a_hundred_and_ten_thousand_times_too_long_do_not_explode) {
  HardCase c("10", "a block falls on a sheet at 1 m/s with dt 0.1 s and 10 s, three solvers");
  // In one such step all layers of a block fall into one, which the solvers then take apart within the next:
  // that is no energy of the flow, but it may not be more than a few support radii a step.
  double beyond = 0, gain = 0;
  Found all;
  for (PressureSolver solver : all_solvers)
    for (double dt : {0.1, 10.0}) {
      ClothSetup setup;
      setup.fluid = solver_of(solver);
      setup.pinned = true;
      setup.world = world_of(1e4);
      double start = 0, highest = 0;
      const auto fill_it = [&](ClothScene<double>& s) {
        fill(s.world(), lattice(8, 8, 8, Vec3(-0.02, 0.01, -0.02)), Vec3(0, -1, 0));
        start = highest = mechanical_energy(s.world());
      };
      const auto look = [&](ClothScene<double>& s, int k) {
        highest = std::max(highest, mechanical_energy(s.world()));
        beyond = std::max(beyond, (fastest(s.world()) - 1 - k * g * dt) * dt / (2 * dx));
      };
      const int steps = dt < 1 ? 8 : 3;  // then nothing leaves the world
      const Found found = run_checked(
          [&](int threads) { return std::make_unique<ClothScene<double>>(setup, threads, fill_it, look); },
          steps, dt);
      all.add(found);
      gain = std::max(gain, (highest - start) / (512 * 1000 * std::pow(dx, 3) * 0.5));
    }
  c.no_crossings(all);
  c.above("impacts", static_cast<double>(all.total.impacts), 0);
  c.below("displacement a step beyond gravity's [H]", beyond, 50);
  c.note("energy above the start's, of the kinetic energy", gain);
}

TEST(HardFluid, ten_crumpled_layers_within_the_support_do_not_crowd_the_density) {
  HardCase c("16", "ten crumpled, self-intersecting layers within H between two blocks of water");
  double density = 0;
  std::uint64_t zone_rounds = 0;
  for (PressureSolver solver : incompressible_solvers)
    for (bool mirrored : {false, true}) {
      ClothSetup setup;
      setup.fluid = solver_of(solver, mirrored);
      setup.layers = 10;
      setup.layer_gap = 0.0008;  // ten of them in 0.8 H
      setup.shape.origin = Vec3(-0.02, 0, -0.02);
      setup.shape.u = Vec3(0.04, 0, 0);
      setup.shape.v = Vec3(0, 0, 0.04);
      const auto make = [&](int threads) {
        return std::make_unique<ClothScene<float>>(
            setup, threads,
            [](ClothScene<float>& s) {
              Random random(16);
              for (auto& cloth : s.cloths)
                for (auto& x : cloth->x)
                  x += random.in_cube(0.003).cast<float>();  // layers pass through each other
              fill(s.world(), lattice(5, 4, 5, Vec3(-0.0103, 0.005, -0.0107)), Vec3(0, -2, 0));
              fill(s.world(), lattice(5, 4, 5, Vec3(-0.0103, -0.028, -0.0107)), Vec3(0, 2, 0));
            },
            [&](ClothScene<float>& s, int) { density = std::max(density, max_density(s.world())); });
      };
      zone_rounds += run_checked(make, 16, 1e-3).total.zone_rounds;
    }
  c.below("largest density [ρ0]", density, 3);
  c.note("zone rounds", zone_rounds);
}

TEST(HardFluid, gravity_from_none_to_a_thousand_g) {
  HardCase c("48", "gravity 0, 1 g and 1000 g on a block over two sheets, pinned and free, three solvers");
  for (double times : {0.0, 1.0, 1000.0}) {
    double speed = 0;
    std::uint64_t zone_rounds = 0;
    for (bool pinned : {true, false})
      for (PressureSolver solver : all_solvers) {
        ClothSetup setup;
        setup.world = world_of(2, Vec3(0, -g * times, 0));
        setup.fluid = solver_of(solver);
        setup.pinned = pinned;
        setup.layers = 2;
        setup.cloth_gravity = setup.world.gravity;
        const auto make = [&](int threads) {
          return std::make_unique<ClothScene<float>>(setup, threads, [](ClothScene<float>& s) {
            fill(s.world(), lattice(6, 6, 6, Vec3(-0.0151, 0.003, -0.0147)));
          });
        };
        const Found found = run_checked(make, 40, 1e-3);
        speed = std::max(speed, found.speed);
        zone_rounds += found.total.zone_rounds;
      }
    const std::string gravity = "speed at " + shown(times) + " g [m/s]";
    if (times == 0) {
      c.below(gravity, speed, 0.05);
    } else {
      c.note(gravity, speed);
    }
    c.note("zone rounds at " + shown(times) + " g", zone_rounds);
  }
}

}  // namespace
}  // namespace oilskin::test
