// Implicit viscosity: what it refuses, what it conserves, and that it is stable.
#include <gtest/gtest.h>

#include <cmath>

#include "effects/honey_world.h"

namespace oilskin {
namespace {

using namespace test;

TEST(ImplicitViscosity, settings_out_of_range_are_refused) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [](double coefficient, double tolerance, int iterations, const char* field) {
    const ImplicitViscositySettings s{coefficient, tolerance, iterations};
    const std::string message = s.validate().message;
    ImplicitViscosity effect(s), other;
    return message.find(field) != std::string::npos && !effect.status().ok() && !other.set_settings(s).ok() &&
           other.settings().coefficient == 0.01;
  };
  for (double bad : {0.0, -1.0, nan, infinity, 2e6})
    EXPECT_TRUE(refuses(bad, 1e-4, 10, "coefficient")) << bad;
  for (double bad : {0.0, -1.0, nan, infinity, 0.2}) EXPECT_TRUE(refuses(1, bad, 10, "tolerance")) << bad;
  for (int bad : {0, -1, 10001}) EXPECT_TRUE(refuses(1, 1e-4, bad, "max_iterations")) << bad;
  EXPECT_TRUE(ImplicitViscositySettings().validate().ok());
}

TEST(ImplicitViscosity, a_world_refuses_an_effect_with_refused_settings) {
  World w(world_of(Vec3::Zero()), fluid_of());
  ImplicitViscosity refused({-1});
  EXPECT_NE(w.add_effect(refused).message.find("viscosity.coefficient"), std::string::npos);
  fill(w, lattice(4, 4, 4, 0.00505, Vec3::Zero()), [](const Vec3& x) { return Vec3(10 * x.y(), 0, 0); });
  const std::vector<Vec3> before(w.velocities().begin(), w.velocities().end());
  ASSERT_TRUE(w.step(1e-3).status.ok());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(w.velocities()[i], before[w.ids()[i] - 1]);
}

// Sparse enough that no pressure acts, which conserves less exactly. One iteration: whatever the residual.
TEST(ImplicitViscosity, a_blob_that_shears_and_spins_keeps_both_momenta_whatever_the_residual) {
  for (int iterations : {1, 500}) {
    World w(world_of(Vec3::Zero()), fluid_of());
    ImplicitViscosity viscosity({0.3, 1e-4, iterations});
    ASSERT_TRUE(w.add_effect(viscosity).ok());
    Random random(7);
    std::vector<Vec3> x = lattice(9, 9, 9, 0.0056, Vec3(0.1, 0.2, 0.3));
    for (Vec3& p : x) p += 2e-4 * random.in_cube(1);
    fill(w, x, [&](const Vec3& p) {
      return Vec3(Vec3(0.1, 0.05, 0) + Vec3(0, 0, 3).cross(p) + Vec3(5 * p.y(), 0, 2 * p.x()) +
                  random.in_cube(0.05));
    });
    const Vec3 p = fluid_momentum(w), l = angular_momentum(w);
    double energy = kinetic_energy(w);
    const double start = energy;
    for (int k = 0; k < 10; ++k) {
      ASSERT_TRUE(w.step(1e-3).status.ok());
      ASSERT_LE(kinetic_energy(w), energy * (1 + 1e-12));
      energy = kinetic_energy(w);
      for (double pressure : w.pressures()) ASSERT_EQ(pressure, 0);
    }
    EXPECT_EQ(viscosity.report().converged, iterations > 1);
    EXPECT_EQ(w.report().messages.empty(), iterations > 1);
    if (iterations == 1) {
      EXPECT_NE(w.report().messages[0].find("less viscosity acts"), std::string::npos);
    }
    EXPECT_LT(energy, 0.998 * start) << "nothing was braked";
    EXPECT_LE((fluid_momentum(w) - p).norm(), 1e-12 * p.norm()) << iterations;
    EXPECT_LE((angular_momentum(w) - l).norm(), 1e-12 * l.norm()) << iterations;
  }
}

/// Decay rate of a wave of shear in the middle of a block, over ν k².
double decay_over_exact(double nu, double dt, int steps, double ratio, bool diagonal) {
  constexpr int n = 24;
  const double dx = 0.005, k = 2 * M_PI / (12 * dx) * (diagonal ? std::sqrt(0.5) : 1);
  const Vec3 along = diagonal ? Vec3(1, 1, 0).normalized() : Vec3(1, 0, 0);
  const Vec3 across = diagonal ? Vec3(-1, 1, 0).normalized() : Vec3(0, 1, 0);
  World w(world_of(Vec3::Zero()), fluid_of(dx, ratio));
  ImplicitViscosity viscosity({nu, 1e-6, 1000});
  EXPECT_TRUE(w.add_effect(viscosity).ok());
  // A little apart: where the lattice's density is above ρ0 by rounding, there would be pressure.
  fill(w, lattice(n, n, 12, 1.0005 * dx, Vec3(-12, -12, -6) * dx),
       [&](const Vec3& x) { return Vec3(1e-4 * std::cos(k * x.dot(across)) * along); });
  const auto amplitude = [&] {
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < w.particle_count(); ++i) {
      const Vec3& x = w.positions()[i];
      if (x.cwiseAbs().maxCoeff() > 0.99 * 3.5 * dx) continue;
      const double c = std::cos(k * x.dot(across));
      sum += c * w.velocities()[i].dot(along);
      weights += c * c;
    }
    return sum / weights;
  };
  const double before = amplitude();
  for (int s = 0; s < steps; ++s) EXPECT_TRUE(w.step(dt).status.ok());
  // Implicit Euler: each step divides by 1 + ν k² dt.
  const double rate = (std::pow(before / amplitude(), 1.0 / steps) - 1) / dt;
  return rate / (nu * k * k);
}

TEST(ImplicitViscosity, a_wave_of_shear_decays_at_its_rate_in_every_direction) {
  for (double ratio : {2.0, 2.5})
    for (bool diagonal : {false, true}) {
      const double found = decay_over_exact(0.02, 2e-4, 2, ratio, diagonal);
      record("rate at H/dx " + std::to_string(ratio) + (diagonal ? " at 45°" : ""), found);
      EXPECT_NEAR(found, 1, 0.05) << "H/dx " << ratio << (diagonal ? " diagonal" : "");
    }
}

/// A block of n × m × n particles that falls into a box, or stands in it.
struct Block {
  double nu = 0.1, dt = 1e-3, dx = 0.005;
  int n = 6, m = 6;
  double height = 0;  ///< over the floor [dx]
  BoundaryModel boundary = BoundaryModel::mirrored;
  SlipModel slip = SlipModel::viscous_wall;
  double beside = 5;  ///< between the block and the walls [dx]
  int max_iterations = 500;
  int threads = 1;
};

class BoxWorld {
 public:
  explicit BoxWorld(const Block& b)
      : world(world_of(Vec3(0, -gravity, 0), b.threads), settings(b)),
        viscosity({b.nu, 1e-4, b.max_iterations}),
        block_(b) {
    EXPECT_TRUE(world.add_effect(viscosity).ok());
    const double side = (b.n + 2 * b.beside) * b.dx;
    box_.add_box({Vec3::Zero(), Vec3(side, (b.m + b.height + 4) * b.dx, side)}, 4 * b.dx);
    SurfaceSettings s = sheet_settings(0.2 * b.dx);
    s.slip.model = b.slip;
    EXPECT_TRUE(world.attach(box_, s, nullptr).ok());
    fill(world, lattice(b.n, b.m, b.n, b.dx, b.dx * Vec3(b.beside, b.height, b.beside)), at_rest);
    start_ = mechanical_energy(world);
  }
  static FluidSettings settings(const Block& b) {
    FluidSettings s = fluid_of(b.dx);
    s.boundary = b.boundary;
    return s;
  }

  void run(double seconds) {
    while (world.time() < seconds - 1e-9) {
      const StepReport& r = world.step(block_.dt);
      ASSERT_TRUE(r.status.ok());
      risen = std::max(risen, r.energy.risen / r.energy.scale);
      gained = std::max(gained, (mechanical_energy(world) - start_) / weight());
      speed = std::max(speed, fastest(world));
      residual = std::max(residual, r.momentum_residual().norm());
      iterations = std::max(iterations, viscosity.report().iterations);
    }
  }
  /// Energy that its fall by its own height sets free [J].
  double weight() const {
    return static_cast<double>(world.particle_count()) * world.particle_mass() * gravity *
           (block_.m + block_.height) * block_.dx;
  }
  double free_fall() const { return std::sqrt(2 * gravity * (block_.m + block_.height) * block_.dx); }

  World world;
  ImplicitViscosity viscosity;
  double risen = 0, gained = 0, speed = 0, residual = 0;
  int iterations = 0;

 private:
  Block block_;
  StaticMesh box_;
  double start_ = 0;
};

/// A lattice that starts too dense: in each step pressure accelerates it, and the viscosity brakes it at
/// once. What the brake takes is lost, and not work that makes up for it: the balance has what is there.
TEST(ImplicitViscosity, what_it_takes_is_lost) {
  const double dx = 0.01;
  World w(world_of(Vec3::Zero()), fluid_of(dx));
  ImplicitViscosity viscosity({0.01});
  ASSERT_TRUE(w.add_effect(viscosity).ok());
  fill(w, lattice(10, 10, 10, 0.93 * dx, Vec3::Zero()), at_rest);
  double largest = 0;
  for (int k = 0; k < 40; ++k) largest = std::max(largest, w.step(0.0005).energy.water_kinetic);
  const EnergyReport& e = w.report().energy;
  EXPECT_GT(largest, 1e-6 * w.fluid_mass());
  EXPECT_NEAR(e.made, e.water_kinetic, 1e-9 * largest);
  EXPECT_NEAR(e.work_outside, 0, 1e-9 * largest);
}

/// A plate that slides under honey works: by its impulses, like any prescribed surface.
TEST(ImplicitViscosity, work_of_a_plate_that_drags_is_that_of_prescribed_nodes) {
  const double dx = 0.01;
  World w(world_of(Vec3::Zero()), fluid_of(dx));
  ImplicitViscosity viscosity({0.1});
  ASSERT_TRUE(w.add_effect(viscosity).ok());
  SlidingMesh plate;
  plate.speed = 0.5;
  plate.add_rectangle(Vec3(-0.2, 0, -0.2), Vec3(0, 0, 0.4), Vec3(0.4, 0, 0), 4, 4);
  SurfaceSettings settings = sheet_settings();
  settings.slip.model = SlipModel::viscous_wall;
  ASSERT_TRUE(w.attach(plate, settings, nullptr).ok());
  fill(w, lattice(8, 4, 8, dx, Vec3(-0.04, 0, -0.04)), at_rest);
  for (int k = 0; k < 60; ++k) w.step(0.001);
  const EnergyReport& e = w.report().energy;
  EXPECT_GT(e.water_kinetic, 0.01 * 0.5 * w.fluid_mass() * 0.25);
  EXPECT_GT(e.work_prescribed, e.water_kinetic);
  EXPECT_NEAR(e.work_outside, 0, 1e-12 * e.work_prescribed);
  EXPECT_LE(e.made_fraction(), 0.01);
}

TEST(ImplicitViscosity, a_dam_and_a_falling_block_make_no_energy) {
  Block dam, falling;
  dam.m = 10;
  falling.nu = 1, falling.height = 8;
  for (const Block& b : {dam, falling}) {
    BoxWorld w(b);
    w.run(0.3);
    const std::string of = b.height > 0 ? " of the block" : " of the dam";
    record("energy made" + of, w.risen);
    record("energy gained" + of, w.gained);
    record("speed over free fall" + of, w.speed / w.free_fall());
    EXPECT_LE(w.risen, 0.01) << of;
    EXPECT_LE(w.gained, 0.01) << of;
    EXPECT_LE(w.speed, w.free_fall()) << of;
    EXPECT_LE(w.residual, 1e-12) << of;
    EXPECT_EQ(w.world.particle_count(), static_cast<std::size_t>(b.n * b.n * b.m));
  }
}

void expect_stable(const Block& b, double seconds) {
  BoxWorld w(b);
  w.run(seconds);
  const std::string at =
      " at ν " + std::to_string(b.nu) + ", dt " + std::to_string(b.dt) + ", dx " + std::to_string(b.dx);
  record("energy made" + at, w.risen);
  record("speed over free fall" + at, w.speed / w.free_fall());
  record("iterations" + at, w.iterations);
  EXPECT_LE(w.risen, 0.02) << at;  // by pressure: 1.5 % at 8 ms
  EXPECT_LE(w.gained, 0.01) << at;
  EXPECT_LE(w.speed, w.free_fall()) << at;
}

TEST(ImplicitViscosity, is_stable_from_a_tenth_of_a_millisecond_to_eight) {
  for (double nu : {1e-3, 10.0})
    for (double dt : {1e-4, 8e-3})
      for (double dx : {2.5e-3, 1e-2}) {
        Block b;
        b.nu = nu, b.dt = dt, b.dx = dx, b.n = 4, b.m = 6, b.height = dt < 1e-3 ? 0.5 : 3;
        expect_stable(b, dt < 1e-3 ? 0.05 : 0.16);
      }
}

TEST(LongImplicitViscosity, is_stable_from_a_tenth_of_a_millisecond_to_eight) {
  for (double nu : {1e-3, 1e-2, 0.1, 1.0, 10.0})
    for (double dt : {1e-4, 1e-3, 4e-3, 8e-3})
      for (double dx : {2.5e-3, 5e-3, 1e-2})
        for (BoundaryModel boundary : {BoundaryModel::mirrored, BoundaryModel::contact_only}) {
          Block b;
          b.nu = nu, b.dt = dt, b.dx = dx, b.n = 5, b.m = 8, b.height = 4, b.boundary = boundary;
          expect_stable(b, 0.15);
        }
}

TEST(ImplicitViscosity, makes_no_energy_where_it_does_not_converge) {
  Block b;
  b.nu = 10, b.height = 8, b.max_iterations = 1;
  BoxWorld w(b);
  w.run(0.15);
  EXPECT_FALSE(w.viscosity.report().converged);
  EXPECT_LE(w.risen, 0.01);
  EXPECT_LE(w.gained, 0.01);
  record("speed over free fall", w.speed / w.free_fall());
}

}  // namespace
}  // namespace oilskin
