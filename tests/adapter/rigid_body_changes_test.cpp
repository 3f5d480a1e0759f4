// Rigid bodies of Bullet that become dynamic, or that are teleported, in the water: where contact holds them
// or carries them, they are where their certified hull is.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "wet_world.h"

namespace oilskin::bullet {
namespace {

using namespace test;

/// Distance between the mean of the hull's nodes and the middle of the body's box [m].
double distance_from_hull(const WetWorld& w, const btRigidBody& body) {
  const SurfaceMotion& hull = *w.solver.getCoupling().getSurface(&body);
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : hull.x_t1) mean += x / static_cast<double>(hull.x_t1.size());
  return (mean - to_vec3(body.getWorldTransform().getOrigin())).norm();
}

constexpr double close_by = is_double ? 1e-12 : 1e-6;

enum class Before { dynamic_elsewhere, disabled_elsewhere, kinematic_from_the_start };

/// A plate is carried to above a layer of water on a floor, as by a player, and let go with 4 m/s.
class Release : public ::testing::TestWithParam<Before> {};

TEST_P(Release, leaves_the_body_where_its_hull_is) {
  WetWorld w(down);
  btRigidBody* floor = w.add_box(0, {bt(0.1), bt(0.02), bt(0.1)}, {0, bt(-0.02), 0});
  ASSERT_TRUE(w.solver.addCollisionObject(floor, bt(0.002)).ok());
  btRigidBody* body = w.add_box(3, {bt(0.04), bt(0.01), bt(0.04)}, {bt(0.3), bt(0.3), 0});
  body->setActivationState(DISABLE_DEACTIVATION);
  const auto carry = [&] {
    if (GetParam() == Before::disabled_elsewhere)
      body->forceActivationState(DISABLE_SIMULATION);
    else
      body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  };
  if (GetParam() == Before::kinematic_from_the_start) carry();
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  ASSERT_TRUE(
      w.water.addBox({bt(-0.06), bt(0.001), bt(-0.06)}, {bt(0.06), bt(0.012), bt(0.06)}, {0, 0, 0}).ok());
  carry();
  for (int k = 1; k <= 12; ++k) {
    btTransform at = body->getWorldTransform();
    at.setOrigin({bt(0.3 - 0.025 * k), bt(0.3 - 0.268 * k / 12), 0});
    body->setWorldTransform(at);
    w.run(1.0 / 60, 1.0 / 60);
  }
  body->setCollisionFlags(body->getCollisionFlags() & ~btCollisionObject::CF_KINEMATIC_OBJECT);
  body->forceActivationState(DISABLE_DEACTIVATION);
  body->setLinearVelocity({0, -4, 0});
  body->setAngularVelocity({0, 0, 0});
  w.run(1.0 / 60, 1.0 / 60);
  EXPECT_GT(w.solver.getReport().contact.held, 0u);
  EXPECT_LT(distance_from_hull(w, *body), close_by);
  EXPECT_LT(body->getWorldTransform().getOrigin().length(), bt(0.04)) << "it stays above the floor";
  w.run(0.1, 1.0 / 60);
  EXPECT_LT(distance_from_hull(w, *body), close_by);
}

INSTANTIATE_TEST_SUITE_P(Carried, Release,
                         ::testing::Values(Before::dynamic_elsewhere, Before::disabled_elsewhere,
                                           Before::kinematic_from_the_start));

/// A light plate appears below a layer of water in the step in which a heavy one hits the layer from above.
TEST(RigidBody, that_is_teleported_and_carried_is_where_its_hull_is) {
  for (const bool by_world : {false, true}) {
    WetWorld w;
    const auto add_plate = [&](double mass, const btVector3& at) {
      auto* shape = new btBoxShape({bt(0.04), bt(0.01), bt(0.04)});
      btRigidBody* plate = w.add(shape, mass, at);
      plate->setActivationState(DISABLE_DEACTIVATION);
      w.bullet.world.removeRigidBody(plate);
      w.bullet.world.addRigidBody(plate, 1, 2);  // they do not touch each other
      EXPECT_TRUE(w.solver.addRigidBody(plate, bt(0.002)).ok());
      return plate;
    };
    constexpr double dt = 1.0 / 120;
    btRigidBody* heavy = add_plate(20, {0, bt(0.022 + 2 * dt), 0});
    btRigidBody* light = add_plate(0.02, {bt(0.4), bt(0.3), 0});
    w.fill({bt(-0.035), 0, bt(-0.035)}, {bt(0.035), bt(0.01), bt(0.035)}, [](const Vec3&) { return true; });
    heavy->setLinearVelocity({0, -2, 0});
    w.run(dt, dt);
    btTransform below = btTransform::getIdentity();
    below.setOrigin({0, bt(-0.0125), 0});
    light->setWorldTransform(below);
    light->setInterpolationWorldTransform(below);
    if (by_world) {
      const SurfaceId id = w.solver.getCoupling().getSurfaceId(light, &w.water);
      w.water.getWorld().reset_motion(id);
    } else {
      w.solver.resetMotion(light);
    }
    w.run(dt, dt);
    EXPECT_GT(w.solver.getReport().contact.zone_points, 0u);
    EXPECT_LT(light->getWorldTransform().getOrigin().y(), bt(-0.014)) << "it was not carried";
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(distance_from_hull(w, *light), close_by) << "step " << k;
      w.run(dt, dt);
    }
  }
}

bool any_contains(const std::vector<std::string>& messages, const std::string& text) {
  return std::any_of(messages.begin(), messages.end(),
                     [&](const std::string& m) { return m.find(text) != std::string::npos; });
}

TEST(RigidBody, that_is_placed_elsewhere_is_said_to_need_a_reset) {
  WetWorld w(down);
  btRigidBody* body = w.add_box(0.1, {bt(0.03), bt(0.03), bt(0.03)}, {0, bt(1), 0});
  body->setLinearVelocity({3, 0, 0});
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.001)).ok());
  w.run(0.3, 1.0 / 60);  // it falls
  EXPECT_FALSE(any_contains(w.solver.takeMessages(), "resetMotion()"));
  for (const bool says_so : {true, false}) {
    btTransform at = body->getWorldTransform();
    at.setOrigin(at.getOrigin() + btVector3(0, bt(0.5), 0));
    body->setWorldTransform(at);
    if (says_so) w.solver.resetMotion(body);
    w.run(1.0 / 60, 1.0 / 60);
    EXPECT_EQ(any_contains(w.solver.takeMessages(), "call resetMotion()"), !says_so);
    w.run(0.1, 1.0 / 60);
    EXPECT_FALSE(any_contains(w.solver.takeMessages(), "resetMotion()"));
  }
}

TEST(RigidBody, that_becomes_dynamic_as_a_collision_object_is_said_not_to_move) {
  WetWorld w(down);
  btRigidBody* body = w.add_box(0, {bt(0.03), bt(0.03), bt(0.03)}, {0, bt(1), 0});
  ASSERT_TRUE(w.solver.addCollisionObject(body, bt(0.001)).ok());
  w.run(0.02, 0.01);
  EXPECT_TRUE(w.solver.takeMessages().empty());
  body->setMassProps(1, btVector3(1, 1, 1));
  body->setCollisionFlags(0);
  w.run(0.01, 0.01);
  EXPECT_TRUE(any_contains(w.solver.takeMessages(), "addRigidBody()"));
}

TEST(Gravity, of_bodies_that_differs_from_that_of_the_fluid_is_reported_once_per_take) {
  const btVector3 along_z(0, 0, bt(-9.81));
  for (const bool is_set : {false, true}) {
    SoftWorld bullet(along_z);
    btFluid water(bt(0.01));
    if (is_set) ASSERT_TRUE(water.setGravity(along_z).ok());
    btFluidCoupling coupling(&water);
    btBoxShape box(btVector3(bt(0.03), bt(0.03), bt(0.03)));
    btRigidBody body(btScalar(0.1), nullptr, &box, btVector3(1, 1, 1));
    bullet.world.addRigidBody(&body);
    EXPECT_TRUE(coupling.addRigidBody(&body, bt(0.001)).ok());
    for (int k = 0; k < 2; ++k) EXPECT_TRUE(coupling.step(bt(0.001)).status.ok());
    EXPECT_EQ(coupling.takeMessages().size(), is_set ? 0u : 1u);
    bullet.world.removeRigidBody(&body);
  }
}

}  // namespace
}  // namespace oilskin::bullet
