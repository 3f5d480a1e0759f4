// Implicit viscosity at dynamic rigid bodies: the drag on them is part of the solution.
#include <gtest/gtest.h>

#include <algorithm>

#include "effects/honey_world.h"
#include "support/mock_body.h"

namespace oilskin {
namespace {

using namespace test;

constexpr double dx = 0.005;

/// A cube of 4 cm in the middle, without weight.
struct Cube {
  World world;
  MockBody body;
  ImplicitViscosity viscosity;

  explicit Cube(double density, double nu, int threads = 1)
      : world(world_of(Vec3::Zero(), threads), fluid_of(dx)), viscosity({nu}) {
    body.half = Vec3::Constant(0.02);
    body.mass = density * 0.04 * 0.04 * 0.04;
    EXPECT_TRUE(world.add_effect(viscosity).ok());
    EXPECT_TRUE(world.attach(body, sheet(SlipModel::viscous_wall), nullptr).ok());
  }
  void add_block(const Vec3& velocity) {
    fill(world, lattice(8, 4, 8, dx, Vec3(-4 * dx, 0.0202, -4 * dx)), [&](const Vec3&) { return velocity; });
  }
  /// Two layers around it.
  void add_coat() {
    std::vector<Vec3> x = lattice(14, 14, 14, dx, Vec3::Constant(-7 * dx));
    x.erase(std::remove_if(x.begin(), x.end(), [](const Vec3& p) { return p.cwiseAbs().maxCoeff() < 0.02; }),
            x.end());
    fill(world, x, at_rest);
  }
  double energy() const { return kinetic_energy(world) + body.kinetic_energy(); }
  Vec3 momentum() const { return fluid_momentum(world) + body.momentum(); }
};

// Drag that acted on a body after the solution alone made 25 times the energy there was.
TEST(ViscousBody, is_taken_along_whatever_its_mass_and_the_step) {
  for (double dt : {1e-3, 4e-3, 1. / 60})
    for (double density : {1., 100., 3000.}) {
      Cube c(density, 1);
      c.body.turns = false;
      c.add_block(Vec3(0.5, 0, 0));
      const Vec3 momentum = c.momentum();
      const double start = c.energy(), water = c.world.particle_mass() * 256;
      for (int k = 0; k < 20; ++k) {
        const StepReport& r = c.world.step(dt);
        ASSERT_TRUE(r.status.ok());
        ASSERT_LE(r.momentum_residual().norm(), 1e-13);
        ASSERT_LE((c.momentum() - momentum).norm(), 1e-13);
        ASSERT_LE(c.energy(), start * (1 + 1e-12)) << density << " kg/m³, step " << k;
      }
      const double together = momentum.x() / (water + c.body.mass);
      record("speed over that of all together", c.body.velocity.x() / together);
      EXPECT_NEAR(c.body.velocity.x(), together, 0.02 * together) << density << " kg/m³, " << dt << " s";
    }
}

TEST(ViscousBody, that_spins_in_thick_liquid_takes_it_along) {
  for (double dt : {1e-3, 1. / 60}) {
    Cube c(100, 0.5);
    c.body.spin = Vec3(0, 3, 0);
    c.add_coat();
    const double start = c.energy();
    for (int k = 0; k < 10; ++k) {
      ASSERT_TRUE(c.world.step(dt).status.ok());
      ASSERT_LT(c.energy(), 0.5 * start) << k;
    }
    const double spin = angular_momentum(c.world).y();
    record("angular momentum of the water over that of the body", spin / c.body.angular_momentum().y());
    EXPECT_GT(spin, 5 * c.body.angular_momentum().y()) << "the coat has 60 times the inertia";
    EXPECT_GT(c.body.spin.y(), 0);
    EXPECT_LT(c.body.spin.y(), 0.3);
    EXPECT_LT(c.momentum().norm(), 1e-12);
  }
}

// One that is infinitely heavy, or locked, is a wall.
TEST(ViscousBody, heavy_and_locked_bodies_drag_as_walls_do) {
  const auto speed_of_water = [](double density, bool locked) {
    Cube c(density, 0.1);
    if (locked) c.body.free_axes.setZero(), c.body.turns = false;
    c.add_block(Vec3(0.5, 0, 0));
    for (int k = 0; k < 5; ++k) EXPECT_TRUE(c.world.step(2e-3).status.ok());
    return fluid_momentum(c.world).x() / (256 * c.world.particle_mass());
  };
  const double wall = speed_of_water(100, true);
  EXPECT_GT(wall, 0);
  EXPECT_LT(wall, 0.45);
  EXPECT_NEAR(speed_of_water(1e12, false), wall, 1e-7);
  EXPECT_GT(speed_of_water(100, false), wall + 0.02) << "a light one yields";
}

TEST(ViscousBody, threads_change_no_bit) {
  Cube one(300, 0.2, 1), two(300, 0.2, 2);
  one.add_block(Vec3(0.3, -0.2, 0.1)), two.add_block(Vec3(0.3, -0.2, 0.1));
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(one.world.step(2e-3).status.ok());
    ASSERT_TRUE(two.world.step(2e-3).status.ok());
    ASSERT_EQ(one.world.state_hash(), two.world.state_hash()) << k;
  }
  EXPECT_EQ(one.body.spin, two.body.spin);
}

}  // namespace
}  // namespace oilskin
