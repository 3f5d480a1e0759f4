// The pressure of water below bodies that stand on something, where no particle gets (B.46).
#include <gtest/gtest.h>

#include <cmath>

#include "wet_world.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr double g = 9.81;

double height_of(const btRigidBody* body) {
  return static_cast<double>(body->getWorldTransform().getOrigin().y());
}

/// Of the load on a body along y, a mean over 0.2 s [N].
double mean_load(WetWorld& w, const btRigidBody* body) {
  double sum = 0;
  for (int k = 0; k < 50; ++k) {
    w.run(0.004, 0.004);
    sum += load_of(*w.solver.getCoupling().getSurface(body)).impulse.y() / 0.004;
  }
  return sum / 50;
}

/// A box of 6 cm that the host holds `above` the floor, in water of 12 cm.
double buoyancy_of_held_box(double above) {
  WetWorld w(down);
  w.add_tank(0.16, 0.2);
  btRigidBody* box = w.add_box(1, {bt(0.03), bt(0.03), bt(0.03)}, {0, bt(0.03 + above), 0});
  box->setLinearFactor({0, 0, 0});
  box->setAngularFactor(btVector3(0, 0, 0));
  EXPECT_TRUE(w.solver.addRigidBody(box, bt(0.002)).ok());
  w.fill_around({bt(-0.08), 0, bt(-0.08)}, {bt(0.08), bt(0.12), bt(0.08)}, box);
  w.run(0.6, 0.004);
  return mean_load(w, box) / (0.06 * 0.06 * 0.06 * 1000 * g);
}

TEST(WaterBelowBodies, lifts_a_box_that_stands_on_the_floor_by_archimedes) {
  EXPECT_NEAR(buoyancy_of_held_box(0), 1, 0.15) << "without it: -1";
  EXPECT_NEAR(buoyancy_of_held_box(0.002), 1, 0.15);
}

TEST(WaterBelowBodies, a_light_crate_that_stands_on_a_flooded_floor_floats_up) {
  WetWorld w(down);
  w.add_tank(0.16, 0.2);
  btRigidBody* crate =
      w.add_box(0.4 * 0.05 * 0.05 * 0.05 * 1000, {bt(0.025), bt(0.025), bt(0.025)}, {0, bt(0.025), 0});
  ASSERT_TRUE(w.solver.addRigidBody(crate, bt(0.002)).ok());
  w.fill_around({bt(-0.08), 0, bt(-0.08)}, {bt(0.08), bt(0.1), bt(0.08)}, crate);
  w.run(1.2, 0.004);
  EXPECT_GT(height_of(crate), 0.09);
}

TEST(WaterBelowBodies, presses_two_bodies_apart_that_stand_on_each_other) {
  WetWorld w(down);
  w.add_tank(0.16, 0.25);
  const btVector3 half(bt(0.03), bt(0.02), bt(0.03));
  const double volume = 0.06 * 0.04 * 0.06;
  btRigidBody *lower = w.add_box(3 * volume * 1000, half, {0, bt(0.02), 0}),
              *upper = w.add_box(3 * volume * 1000, half, {0, bt(0.06), 0});
  for (btRigidBody* body : {lower, upper}) ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  w.fill({bt(-0.08), 0, bt(-0.08)}, {bt(0.08), bt(0.14), bt(0.08)},
         [](const Vec3& x) { return std::abs(x.x()) > 0.033 || std::abs(x.z()) > 0.033 || x.y() > 0.083; });
  w.run(0.6, 0.004);
  EXPECT_NEAR(mean_load(w, lower) / (volume * 1000 * g), 1, 0.25);
  EXPECT_NEAR(mean_load(w, upper) / (volume * 1000 * g), 1, 0.25);
  EXPECT_LT(w.solver.getReport().momentum_residual().norm(), 1e-9);
}

TEST(WaterBelowBodies, is_not_there_where_the_floor_is_dry) {
  WetWorld w(down);
  w.add_tank(0.3, 0.2);
  auto* bucket = new btCompoundShape;
  std::vector<std::unique_ptr<btBoxShape>> parts;
  const auto add = [&](const btVector3& half, const btVector3& at) {
    parts.push_back(std::make_unique<btBoxShape>(half));
    parts.back()->setMargin(bt(0.001));
    bucket->addChildShape(btTransform(btQuaternion::getIdentity(), at), parts.back().get());
  };
  const btScalar t = bt(0.005), wide = bt(0.05), tall = bt(0.04);
  add({wide, t, wide}, {0, 0, 0});
  for (const btScalar side : {bt(-1), bt(1)}) {
    add({wide, tall, t}, {0, tall + t, side * (wide - t)});
    add({t, tall, wide - 2 * t}, {side * (wide - t), tall + t, 0});
  }
  btRigidBody* body = w.add(bucket, 1, {0, t, 0});
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  w.fill({bt(-0.038), bt(0.012), bt(-0.038)}, {bt(0.038), bt(0.06), bt(0.038)},
         [](const Vec3&) { return true; });
  w.run(0.4, 0.004);
  const double weight =
      static_cast<double>(w.water.getNumParticles()) * w.water.getWorld().particle_mass() * g;
  EXPECT_NEAR(mean_load(w, body), -weight, 0.02 * weight) << "the bottom and its walls are parts";
}

TEST(WaterBelowBodies, acts_with_half_its_pressure_between_wet_and_dry) {
  WetWorld w(down);
  w.add_tank(0.16, 0.2);
  btRigidBody* dam = w.add_box(1, {bt(0.03), bt(0.06), bt(0.079)}, {0, bt(0.06), 0});
  dam->setLinearFactor({0, 0, 0});
  dam->setAngularFactor(btVector3(0, 0, 0));
  ASSERT_TRUE(w.solver.addRigidBody(dam, bt(0.002)).ok());
  w.fill({bt(-0.08), 0, bt(-0.08)}, {bt(-0.033), bt(0.1), bt(0.08)}, [](const Vec3&) { return true; });
  w.run(0.8, 0.004);
  const double depth = static_cast<double>(w.water.getVolume()) / (0.05 * 0.16);
  EXPECT_NEAR(mean_load(w, dam) / (1000 * g * depth * 0.06 * 0.158), 0.5, 0.2);
}

}  // namespace
}  // namespace oilskin::bullet
