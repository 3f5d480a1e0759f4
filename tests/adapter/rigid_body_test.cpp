// Dynamic rigid bodies of Bullet in the water.
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "wet_world.h"

namespace oilskin::bullet {
namespace {

using namespace test;

Vec3 momentum(const btRigidBody& body) {
  return to_vec3(body.getLinearVelocity()) / static_cast<double>(body.getInvMass());
}

TEST(RigidBody, takes_the_momentum_that_the_water_loses) {
  for (int shape = 0; shape < 4; ++shape) {
    WetWorld w;
    btConvexHullShape* hull = new btConvexHullShape();
    for (int c = 0; c < 8; ++c)
      hull->addPoint(btVector3(bt(c & 1 ? 0.05 : -0.05), bt(c & 2 ? 0.03 : -0.03), bt(c & 4 ? 0.06 : -0.02)));
    btCompoundShape* compound = new btCompoundShape();
    btBoxShape part(btVector3(bt(0.03), bt(0.03), bt(0.03)));
    for (double at : {-0.03, 0.03})
      compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(bt(at), 0, 0)), &part);
    btCollisionShape* shapes[] = {new btBoxShape(btVector3(bt(0.05), bt(0.03), bt(0.05))), hull, compound,
                                  new btSphereShape(bt(0.05))};
    btRigidBody* body = nullptr;
    for (int s = 0; s < 4; ++s)
      if (s == shape)
        body = w.add(shapes[s], 0.2, btVector3(0, 0, 0));
      else
        delete shapes[s];
    body->setDamping(0, 0);
    body->setAngularVelocity(btVector3(2, -1, 3));
    ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.001)).ok());
    ASSERT_TRUE(
        w.water.addBox({bt(0), bt(0.08), bt(-0.03)}, {bt(0.06), bt(0.13), bt(0.03)}, {0, -2, 0}).ok());
    w.run(0.002, 0.002);
    const Vec3 start = w.water_momentum() + momentum(*body);
    w.run(0.1, 0.002);
    EXPECT_GT(momentum(*body).norm(), 0.1 * start.norm()) << "shape " << shape;
    const Vec3 gained = w.water_momentum() + momentum(*body) - start;
    EXPECT_LE(gained.norm(), (is_double ? 1e-12 : 1e-5) * start.norm()) << "shape " << shape;
    EXPECT_GT(body->getAngularVelocity().length(), 0.1);
  }
}

TEST(RigidBody, floats_with_the_draught_of_archimedes) {
  WetWorld w(down);
  w.add_tank(0.2, 0.2);
  btRigidBody* body =
      w.add_box(0.5 * 0.09 * 0.06 * 0.09 * 1000, {bt(0.045), bt(0.03), bt(0.045)}, {0, bt(0.09), 0});
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  w.fill_around({bt(-0.1), 0, bt(-0.1)}, {bt(0.1), bt(0.09), bt(0.1)}, body);
  const double volume = static_cast<double>(w.water.getNumParticles()) * 1e-6;
  w.run(0.6, 0.005);
  double draught = 0;
  for (int k = 0; k < 40; ++k) {
    w.run(0.005, 0.005);
    const double level = (volume + 0.5 * 0.09 * 0.06 * 0.09) / 0.04;
    draught += (level - (static_cast<double>(body->getWorldTransform().getOrigin().y()) - 0.03)) / 40;
  }
  EXPECT_NEAR(draught, 0.03, 0.4 * 0.01);
  EXPECT_EQ(body->getActivationState(), ACTIVE_TAG) << "water keeps it awake";
}

// It has 180 triangles here, with its volume.
TEST(RigidBody, a_ball_of_half_the_density_floats_with_its_centre_at_the_level) {
  constexpr double radius = 0.03, volume = 4.0 / 3 * 3.14159265358979 * radius * radius * radius;
  WetWorld w(down);
  w.add_tank(0.2, 0.2);
  const Vec3 start(0, 0.09, 0);
  btRigidBody* body = w.add(new btSphereShape(bt(radius)), 0.5 * volume * 1000, to_bt(start));
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  ASSERT_EQ(w.solver.getCoupling().getSurface(body)->triangles.size(), 180u);
  w.fill({bt(-0.1), 0, bt(-0.1)}, {bt(0.1), bt(0.09), bt(0.1)},
         [&](const Vec3& x) { return (x - start).norm() > radius + 0.004; });
  const double level = (static_cast<double>(w.water.getNumParticles()) * 1e-6 + 0.5 * volume) / 0.04;
  w.run(0.6, 0.005);
  double below = 0;
  for (int k = 0; k < 40; ++k) {
    w.run(0.005, 0.005);
    below += (level - static_cast<double>(body->getWorldTransform().getOrigin().y())) / 40;
  }
  EXPECT_NEAR(below, 0, 0.3 * 0.01);
}

/// Of a crate in 0.2 s.
struct Unrest {
  double rocks, moves;  ///< [rad], [m]
};

/// A crate twice as dense as water sinks from `height` to Bullet's floor.
static Unrest unrest_on_the_floor(double height) {
  WetWorld w(down);
  w.add_tank(0.14, 0.2);
  btRigidBody* body =
      w.add_box(2.0 * 0.06 * 0.06 * 0.06 * 1000, {bt(0.03), bt(0.03), bt(0.03)}, {0, bt(height), 0});
  EXPECT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  w.fill_around({bt(-0.07), 0, bt(-0.07)}, {bt(0.07), bt(0.1), bt(0.07)}, body);
  w.run(1.2, 0.004);
  const btTransform before = body->getWorldTransform();
  w.run(0.2, 0.004);
  const btTransform& now = body->getWorldTransform();
  EXPECT_GT(static_cast<double>(now.getOrigin().y()), 0.0295);
  EXPECT_LT(static_cast<double>(now.getOrigin().y()), 0.04) << "one layer of particles may stay below it";
  // Nothing brakes a turn about the vertical on a layer of water without friction.
  EXPECT_LT(static_cast<double>(before.getRotation().angleShortestPath(now.getRotation())), 0.15);
  const btVector3 up_before = before.getBasis().getColumn(1), up = now.getBasis().getColumn(1);
  return {static_cast<double>(up_before.cross(up).length()),
          static_cast<double>((now.getOrigin() - before.getOrigin()).length())};
}

/// On the few particles that stay below, a crate may rock: of 40 heights 0.013 is the mean, 0.07 the
/// most, and 9 exceed 0.02. It moves by 0.9 mm in the mean, 2.1 mm at most.
TEST(RigidBody, sinks_where_it_is_heavier_and_comes_to_rest_on_bullets_floor) {
  std::vector<double> rocks, moves;
  for (const double height : {0.05, 0.0501, 0.0502}) {
    const Unrest unrest = unrest_on_the_floor(height);
    rocks.push_back(unrest.rocks);
    moves.push_back(unrest.moves);
  }
  std::sort(rocks.begin(), rocks.end());
  std::sort(moves.begin(), moves.end());
  EXPECT_LT(rocks[1], 0.02) << "it does not rock";
  EXPECT_LT(rocks[2], 0.1);
  EXPECT_LT(moves[1], 0.002);
  EXPECT_LT(moves[2], 0.004);
}

TEST(RigidBody, respects_factors_and_what_bullet_calls_dynamic) {
  WetWorld w;
  btRigidBody* body = w.add_box(0.1, {bt(0.03), bt(0.03), bt(0.03)}, {0, 0, 0});
  body->setLinearFactor(btVector3(1, 0, 1));
  body->setAngularFactor(btVector3(0, 1, 0));
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.001)).ok());
  ASSERT_TRUE(
      w.water.addBox({bt(0), bt(0.05), bt(-0.02)}, {bt(0.06), bt(0.09), bt(0.02)}, {bt(0.5), -2, 0}).ok());
  w.run(0.05, 0.002);
  EXPECT_EQ(body->getLinearVelocity().y(), 0);
  EXPECT_EQ(body->getAngularVelocity().x(), 0);
  EXPECT_GT(w.water.getNumParticles(), 0);
  const SurfaceMotion* surface = w.solver.getCoupling().getSurface(body);
  ASSERT_TRUE(surface && surface->body);

  // Kinematic from now on: no impulse reaches it, and its nodes are prescribed.
  body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  body->setLinearVelocity(btVector3(0, 0, 0));
  w.run(0.02, 0.002);
  EXPECT_EQ(body->getLinearVelocity().length(), 0);
  EXPECT_FALSE(w.solver.getCoupling().getSurface(body)->body.has_value());
}

TEST(RigidBody, is_woken_by_water_and_may_be_taken_out_and_deleted_wet) {
  WetWorld w;
  btRigidBody* body = w.add_box(0.1, {bt(0.03), bt(0.03), bt(0.03)}, {0, 0, 0});
  w.solver.setCollisionWorld(&w.bullet.world);
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.001)).ok());
  body->setActivationState(ISLAND_SLEEPING);
  w.run(0.01, 0.002);
  EXPECT_EQ(body->getActivationState(), ISLAND_SLEEPING);
  ASSERT_TRUE(
      w.water.addBox({bt(-0.02), bt(0.05), bt(-0.02)}, {bt(0.02), bt(0.09), bt(0.02)}, {0, -2, 0}).ok());
  w.run(0.05, 0.002);
  EXPECT_EQ(body->getActivationState(), ACTIVE_TAG);
  EXPECT_LT(body->getLinearVelocity().y(), bt(-0.05));

  w.bullet.world.removeRigidBody(body);
  w.run(0.004, 0.002);
  EXPECT_EQ(w.solver.getCoupling().getSurface(body), nullptr);
  const std::vector<std::string> messages = w.solver.takeMessages();
  EXPECT_FALSE(messages.empty());
  w.bullet.world.addRigidBody(body);
  EXPECT_TRUE(w.solver.addRigidBody(body, bt(0.001)).ok());
  w.solver.removeRigidBody(body);
  w.solver.removeRigidBody(body);
}

TEST(RigidBody, refusals_say_what_to_do) {
  WetWorld w;
  btRigidBody* body = w.add_box(0.1, {bt(0.03), bt(0.03), bt(0.03)}, {0, 0, 0});
  EXPECT_NE(w.solver.addRigidBody(nullptr, bt(0.001)).message.find("null"), std::string::npos);
  EXPECT_NE(w.solver.addCollisionObject(body, bt(0.001)).message.find("addRigidBody()"), std::string::npos);
  EXPECT_FALSE(w.solver.addRigidBody(body, bt(-1)).ok());
  EXPECT_FALSE(w.solver.addRigidBody(body, bt(50)).ok()) << "millimetres";
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.001)).ok());
  EXPECT_NE(w.solver.addRigidBody(body, bt(0.001)).message.find("already"), std::string::npos);
  btFluidCoupling other;
  EXPECT_NE(other.addRigidBody(body, bt(0.001)).message.find("another coupling"), std::string::npos);
  btRigidBody* scaled = w.add_box(0.1, {bt(0.03), bt(0.03), bt(0.03)}, {0, 0, 0});
  for (const btScalar size : {bt(2), bt(-1), bt(0)}) {
    scaled->getWorldTransform().getBasis().setValue(size, 0, 0, 0, 1, 0, 0, 0, 1);
    EXPECT_NE(w.solver.addRigidBody(scaled, bt(0.001)).message.find("scales or mirrors"), std::string::npos);
  }
  scaled->getWorldTransform().setIdentity();
  btPairCachingGhostObject ghost;
  btCapsuleShape capsule(bt(0.05), bt(0.1));
  ghost.setCollisionShape(&capsule);
  ghost.setCollisionFlags(btCollisionObject::CF_CHARACTER_OBJECT);
  EXPECT_NE(w.solver.addCollisionObject(&ghost, bt(0.001)).message.find("CF_KINEMATIC_OBJECT"),
            std::string::npos);
  ghost.setCollisionFlags(btCollisionObject::CF_CHARACTER_OBJECT | btCollisionObject::CF_KINEMATIC_OBJECT);
  EXPECT_TRUE(w.solver.addCollisionObject(&ghost, bt(0.001)).ok());
  w.solver.removeCollisionObject(&ghost);
}

/// Particles that a press removes which drives a body of `mass` through water onto the floor. `offset` is
/// that of the body from the middle [m].
std::uint64_t removed_by_press(double mass, double offset) {
  WetWorld w(down);
  w.add_tank(0.1, 0.2);
  btRigidBody* body = w.add_box(mass, {bt(0.03), bt(0.01), bt(0.03)}, {bt(offset), bt(0.05), 0});
  btRigidBody* press = w.add_box(0, {bt(0.04), bt(0.01), bt(0.04)}, {0, bt(0.1), 0});
  press->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  press->setActivationState(DISABLE_DEACTIVATION);
  EXPECT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  EXPECT_TRUE(w.solver.addCollisionObject(press, bt(0.002)).ok());
  w.fill_around({bt(-0.05), 0, bt(-0.05)}, {bt(0.05), bt(0.06), bt(0.05)}, body);
  std::uint64_t lost = 0;
  for (int k = 0; k < 40; ++k) {
    btTransform at = press->getWorldTransform();
    at.setOrigin(btVector3(0, bt(std::max(0.02, 0.1 - 0.004 * k)), 0));
    press->setWorldTransform(at);
    w.run(0.005, 0.005);
    lost += w.solver.getReport().contact.removed;
  }
  EXPECT_TRUE(to_vec3(body->getWorldTransform().getOrigin()).allFinite());
  return lost;
}

/// The largest distance between the nodes of a box and those of the body's own box [m].
double deviation_of_hull(const SurfaceMotion& hull, const btRigidBody& body, const btVector3& half) {
  double largest = 0;
  for (const Vec3& x : hull.x_t1) {
    const btVector3 local = body.getWorldTransform().invXform(to_bt(x)).absolute() - half;
    largest = std::max(largest, to_vec3(local).cwiseAbs().maxCoeff());
  }
  return largest;
}

/// Fluid sub-steps divide its turn: contact may hold it after any of them.
TEST(RigidBody, that_turns_while_contact_holds_it_keeps_its_shape) {
  WetWorld w(down);
  w.add_tank(0.1, 0.2);
  const btVector3 half(bt(0.025), bt(0.01), bt(0.025));
  btRigidBody* body = w.add_box(0.3, half, {0, bt(0.04), 0});
  btRigidBody* press = w.add_box(0, {bt(0.04), bt(0.01), bt(0.04)}, {0, bt(0.09), 0});
  press->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  press->setActivationState(DISABLE_DEACTIVATION);
  body->setActivationState(DISABLE_DEACTIVATION);
  body->setAngularVelocity(btVector3(30, 0, 30));
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  ASSERT_TRUE(w.solver.addCollisionObject(press, bt(0.002)).ok());
  w.fill_around({bt(-0.05), 0, bt(-0.05)}, {bt(0.05), bt(0.05), bt(0.05)}, body);
  int held = 0;
  for (int k = 0; k < 40; ++k) {
    btTransform at = press->getWorldTransform();
    at.setOrigin(btVector3(0, bt(std::max(0.03, 0.09 - 0.003 * k)), 0));
    press->setWorldTransform(at);
    w.run(1.0 / 60, 1.0 / 60);
    const SurfaceMotion& hull = *w.solver.getCoupling().getSurface(body);
    const auto is_moved = [](std::uint8_t moved) { return moved != 0; };
    if (std::any_of(hull.moved.begin(), hull.moved.end(), is_moved)) ++held;
    EXPECT_LT(deviation_of_hull(hull, *body, half), is_double ? 1e-12 : 1e-7) << "step " << k;
  }
  EXPECT_GT(held, 3);
}

/// Masses of a millionth and a million times the water's. How many are closed in depends on how the body
/// tilts: runs whose starts differ by 1e-6 m lose 0 to 40, one in twenty 100 to 200, so that the middle of
/// three is judged.
TEST(RigidBody, that_is_crushed_in_water_lets_nothing_through) {
  for (const double mass : {1e-6, 1., 1e6}) {
    std::array<std::uint64_t, 3> lost{};
    for (std::size_t k = 0; k < lost.size(); ++k)
      lost[k] = removed_by_press(mass, 1e-6 * static_cast<double>(k));
    std::sort(lost.begin(), lost.end());
    // 0.06 · 0.06 · 0.04 m³ of water, 144 particles, lie below the body; most of them must get out.
    EXPECT_LT(lost[1], 48u) << "what the press closes on may be removed, and is counted; mass " << mass;
  }
}

}  // namespace
}  // namespace oilskin::bullet
