// Rigid bodies of Bullet among other things in the water.
#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>

#include "oilskin/wetting.h"
#include "wet_world.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr double g = 9.81;  // [m/s²]

/// An open box of five boxes, 4 cm wide and 8 cm deep inside; its inner floor is at y = 0.
btRigidBody* add_bucket(WetWorld& w, double mass) {
  const btScalar h = bt(0.02), t = bt(0.005), d = bt(0.04);
  static btBoxShape base({h + 2 * t, t, h + 2 * t}), side({t, d, h + 2 * t}), front({h, d, t});
  btCompoundShape* bucket = new btCompoundShape();
  const auto add = [&](btBoxShape& part, const btVector3& at) {
    bucket->addChildShape(btTransform(btQuaternion::getIdentity(), at), &part);
  };
  add(base, {0, -t, 0});
  for (const btScalar s : {bt(-1), bt(1)}) {
    add(side, {s * (h + t), d, 0});
    add(front, {0, d, s * (h + t)});
  }
  return w.add(bucket, mass, {0, 0, 0});
}

/// Mean height of the water above the floor of the bucket after a second [m].
double height_in_a_bucket(bool is_free, double dt) {
  WetWorld w(down);
  btRigidBody* ground = w.add_box(0, {bt(0.3), bt(0.05), bt(0.3)}, {0, bt(-0.06), 0});
  EXPECT_TRUE(w.solver.addCollisionObject(ground, bt(0.002)).ok());
  btRigidBody* bucket = add_bucket(w, is_free ? 0.2 : 0);
  EXPECT_TRUE(
      (is_free ? w.solver.addRigidBody(bucket, bt(0.002)) : w.solver.addCollisionObject(bucket, bt(0.002)))
          .ok());
  w.fill({bt(-0.02), 0, bt(-0.02)}, {bt(0.02), bt(0.06), bt(0.02)}, [](const Vec3&) { return true; });
  w.run(1, dt);
  double height = -static_cast<double>(bucket->getWorldTransform().getOrigin().y());
  for (const Vec3& x : w.water.getWorld().positions()) height += x.y() / w.water.getNumParticles();
  return height;
}

TEST(RigidBodyScene, water_stands_as_high_in_a_free_bucket_as_in_a_fixed_one) {
  for (const double dt : {1.0 / 60, 1.0 / 120}) {
    const double fixed = height_in_a_bucket(false, dt), free = height_in_a_bucket(true, dt);
    EXPECT_NEAR(free, fixed, 0.01 * 0.03) << "half the depth is 3 cm; at " << dt;
  }
}

/// It weighs 5 % of its water.
TEST(RigidBodyScene, a_light_bucket_on_a_rope_hangs_still) {
  WetWorld w(down);
  btRigidBody* bucket = add_bucket(w, 0.05 * 0.096);
  ASSERT_TRUE(w.solver.addRigidBody(bucket, bt(0.002)).ok());
  btPoint2PointConstraint rope(*bucket, {0, bt(0.4), 0});
  w.bullet.world.addConstraint(&rope);
  w.fill({bt(-0.02), 0, bt(-0.02)}, {bt(0.02), bt(0.06), bt(0.02)}, [](const Vec3&) { return true; });
  w.run(1, 1.0 / 60);
  ASSERT_EQ(w.water.getNumParticles(), 96);
  EXPECT_LT(bucket->getWorldTransform().getOrigin().length(), bt(0.001));
  for (const Vec3& x : w.water.getWorld().positions()) {
    EXPECT_LT(x.cwiseAbs().maxCoeff(), 0.065);
    EXPECT_GT(x.y(), 0);
  }
  w.bullet.world.removeConstraint(&rope);
}

/// Hosts trap such operations to find their own errors.
TEST(RigidBodyScene, nothing_invalid_is_computed) {
  WetWorld w(down);
  w.add_tank(0.1, 0.1);
  btRigidBody* ball = w.add(new btSphereShape(bt(0.02)), 0.02, {0, bt(0.08), 0});
  ASSERT_TRUE(w.solver.addRigidBody(ball, bt(0.002)).ok());
  w.fill({bt(-0.05), 0, bt(-0.05)}, {bt(0.05), bt(0.05), bt(0.05)}, [](const Vec3&) { return true; });
  std::feclearexcept(FE_ALL_EXCEPT);
  w.run(0.3, 0.005);
  EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_DIVBYZERO), 0);
}

TEST(RigidBodyScene, a_jet_knocks_over_a_stack_of_crates_and_throws_none_out) {
  WetWorld w(down);
  btRigidBody* ground = w.add_box(0, {bt(1.8), bt(0.05), 1}, {0, bt(-0.05), 0});
  ASSERT_TRUE(w.solver.addCollisionObject(ground, bt(0.002)).ok());
  std::vector<btRigidBody*> crates;
  for (int k = 0; k < 3; ++k) {
    crates.push_back(
        w.add_box(0.05, {bt(0.03), bt(0.03), bt(0.03)}, {0, bt(0.032 + 0.061 * k), 0}));  // 230 kg/m³
    ASSERT_TRUE(w.solver.addRigidBody(crates.back(), bt(0.002)).ok());
  }
  w.run(0.2, 0.004);
  for (const btRigidBody* crate : crates) EXPECT_NEAR(crate->getWorldTransform().getOrigin().x(), 0, 0.002);

  DiscEmitter jet;
  jet.center = {-0.25, 0.15, 0};
  jet.direction = {1, 0, 0};
  jet.speed = 3;
  ASSERT_TRUE(w.water.getWorld().add_emitter(jet).ok());
  double fastest = 0;
  for (int k = 0; k < 125; ++k) {
    w.run(0.004, 0.004);
    for (const btRigidBody* crate : crates)
      fastest = std::max(fastest, static_cast<double>(crate->getLinearVelocity().length()));
  }
  EXPECT_GT(crates[2]->getWorldTransform().getOrigin().x(), bt(0.1)) << "the jet hits the crate on top";
  EXPECT_LT(crates[2]->getWorldTransform().getOrigin().y(), bt(0.1)) << "it fell";
  EXPECT_LT(fastest, 3.0 + std::sqrt(2 * g * 0.2)) << "the jet's speed, and that of the fall";
  for (const btRigidBody* crate : crates) EXPECT_GT(crate->getWorldTransform().getOrigin().y(), bt(0.02));
}

/// Bullet holds the body on the cloth; the water makes the cloth heavy and falls on both. Bullet's contact of
/// nodes with a body needs a wide margin and steps of 1 ms to hold it, with water or without.
TEST(RigidBodyScene, a_body_lies_on_cloth_that_gets_wet) {
  Wetting wetting;
  WetWorld w(down);
  w.solver.setCouplingInterval(4);
  w.bullet.world.getWorldInfo().m_sparsesdf.setDefaultVoxelsz(bt(0.02));
  btSoftBody* cloth = w.bullet.patch(21, 0.4, 0, 15, 0.2);
  cloth->m_cfg.piterations = 10;
  cloth->m_cfg.kDP = bt(0.01);
  cloth->m_cfg.kDF = 1;
  cloth->getCollisionShape()->setMargin(bt(0.02));
  ASSERT_TRUE(w.solver.addCloth(cloth, bt(0.002)).ok());
  btRigidBody* body = w.add_box(0.03, {bt(0.04), bt(0.02), bt(0.04)}, {0, bt(0.04), 0});
  ASSERT_TRUE(w.solver.addRigidBody(body, bt(0.002)).ok());
  ASSERT_TRUE(w.water.getWorld().add_effect(wetting).ok());
  w.run(0.4, 0.001);
  EXPECT_NEAR(body->getWorldTransform().getOrigin().y(), 0, 0.05) << "it lies on the cloth";
  ASSERT_TRUE(w.water.addBox({bt(-0.06), bt(0.08), bt(-0.06)}, {bt(0.06), bt(0.14), bt(0.06)}).ok());
  double absorbed = 0;
  for (int k = 0; k < 125; ++k) {
    w.run(0.004, 0.001);
    absorbed += w.solver.getReport().mass_absorbed;
  }
  EXPECT_GT(absorbed, 0.001) << "kg, of the cloth's 0.2";
  const btVector3 at = body->getWorldTransform().getOrigin();
  EXPECT_GT(at.y(), bt(-0.12)) << "it lies on the cloth, which is stretched by the water";
  EXPECT_LT(btVector3(at.x(), 0, at.z()).length(), bt(0.2));
  EXPECT_LT(body->getLinearVelocity().length(), bt(1.5));
}

/// Bullet lets a body and light cloth overlap a little, with water between them. The body must move on: one
/// that is held at its place, while Bullet pushes it, is shot off later.
TEST(RigidBodyScene, a_crate_falls_on_light_wet_cloth_and_is_not_held) {
  WetWorld w(down);
  btSoftBody* cloth = w.bullet.patch(33, 0.4, 0, 15, 0.05);
  cloth->m_cfg.piterations = 10;
  cloth->getCollisionShape()->setMargin(bt(0.005));
  ASSERT_TRUE(w.solver.addCloth(cloth, bt(0.002)).ok());
  btRigidBody* crate = w.add_box(0.06, {bt(0.03), bt(0.03), bt(0.03)}, {bt(0.07), bt(0.35), bt(0.02)});
  ASSERT_TRUE(w.solver.addRigidBody(crate, bt(0.002)).ok());
  ASSERT_TRUE(w.water.addJet({0, bt(0.2), 0}, {0, -1, 0}, 1, bt(0.03)).ok());
  double fastest = 0, lowest = 1;
  std::uint64_t held = 0, wedged = 0;
  for (int k = 0; k < 500; ++k) {
    w.run(0.001, 0.001);
    const ContactReport& contact = w.solver.getReport().contact;
    held += contact.held > 0;
    wedged += contact.zone_rounds > 0;
    fastest = std::max(fastest, double(crate->getLinearVelocity().length()));
    lowest = std::min(lowest, double(crate->getWorldTransform().getOrigin().y()));
    EXPECT_EQ(contact.crossings_found_by_verify, 0u);
  }
  EXPECT_GT(wedged, 10u) << "or the case is too easy";
  EXPECT_LT(lowest, 0) << "it lands on the cloth, which yields";
  EXPECT_LE(held, 5u) << "steps";
  EXPECT_LT(fastest, 4) << "m/s: it falls at 2.6";
}

/// Water between two crates and a cloth wedges both bodies. They move on together; where they were held in
/// each step, the cloth went on to push them, and shot them off.
TEST(RigidBodyScene, crates_that_fall_on_each_other_on_wet_cloth_are_not_held) {
  WetWorld w(down);
  btSoftBody* cloth = w.bullet.patch(21, 0.3, 0, 15, 0.3);
  cloth->m_cfg.piterations = 10;
  cloth->getCollisionShape()->setMargin(bt(0.005));
  ASSERT_TRUE(w.solver.addCloth(cloth, bt(0.001)).ok());
  ASSERT_TRUE(w.water.addBox({bt(-0.1), bt(0.006), bt(-0.1)}, {bt(0.1), bt(0.03), bt(0.1)}).ok());
  ASSERT_TRUE(w.water.addBox({bt(-0.03), bt(0.125), bt(-0.03)}, {bt(0.03), bt(0.145), bt(0.03)}).ok());
  btRigidBody* crates[] = {w.add_box(0.2, {bt(0.04), bt(0.03), bt(0.04)}, {0, bt(0.08), 0}),
                           w.add_box(0.27, {bt(0.04), bt(0.03), bt(0.04)}, {bt(0.005), bt(0.2), 0})};
  for (btRigidBody* crate : crates) ASSERT_TRUE(w.solver.addRigidBody(crate, bt(0.001)).ok());
  crates[1]->setLinearVelocity({0, bt(-3.7), 0});
  double fastest = 0;
  int in_a_row = 0, longest = 0;
  btVector3 before = crates[0]->getWorldTransform().getOrigin();
  for (int k = 0; k < 125; ++k) {
    w.run(0.004, 0.004);
    EXPECT_EQ(w.solver.getReport().contact.crossings_found_by_verify, 0u);
    for (const btRigidBody* crate : crates)
      fastest = std::max(fastest, double(crate->getLinearVelocity().length()));
    const btVector3 at = crates[0]->getWorldTransform().getOrigin();
    in_a_row = at == before ? in_a_row + 1 : 0;
    before = at;
    longest = std::max(longest, in_a_row);
  }
  EXPECT_LE(longest, 2) << "steps at one place";
  EXPECT_LT(fastest, 4.5) << "m/s: the upper one arrives at 3.9";
}

/// In an ideal fluid a sphere that is let go accelerates by g (s − 1)/(s + ½), s its density over the
/// water's: it takes half its volume of water along. The velocity that a step leaves holds the impulse of the
/// water, but not yet the gravity with which the body moves on; the first step, whose gravity the held body
/// had not felt, is left out.
void let_a_sphere_go(double across, double width, double s) {
  WetWorld w(down);
  w.add_tank(width, 2 * width);
  const double radius = across / 2;
  btRigidBody* sphere =
      w.add(new btSphereShape(bt(radius)), 1000 * s * 4.0 / 3 * 3.14159265358979 * std::pow(radius, 3),
            {0, bt(width / 2), 0});
  sphere->setDamping(0, 0);
  sphere->setActivationState(DISABLE_DEACTIVATION);
  sphere->setLinearFactor({0, 0, 0});
  ASSERT_TRUE(w.solver.addRigidBody(sphere, bt(0.002)).ok());
  const Vec3 centre(0, width / 2, 0);
  const btScalar half = bt(width / 2);
  w.fill({-half, 0, -half}, {half, bt(width), half},
         [&](const Vec3& x) { return (x - centre).norm() > radius + 0.003; });
  w.run(0.6, 0.002);  // until the water is at rest; after 0.4 s it gave the sphere 3 % less
  sphere->setLinearFactor({1, 1, 1});
  w.run(0.002, 0.002);
  const btScalar start = sphere->getLinearVelocity().y();
  w.run(0.018, 0.002);
  const double expected = -g * (s - 1) / (s + 0.5);
  const double acceleration = static_cast<double>(sphere->getLinearVelocity().y() - start) / 0.018;
  EXPECT_NEAR(acceleration, expected, 0.1 * std::abs(expected)) << "s = " << s;
  EXPECT_LT(std::hypot(static_cast<double>(sphere->getLinearVelocity().x()),
                       static_cast<double>(sphere->getLinearVelocity().z())),
            0.1 * 0.02 * std::abs(expected));
}

struct Sphere {
  double across, width, density;  ///< [m], of the tank [m], over the water's
};

class AddedMass : public testing::TestWithParam<Sphere> {};
TEST_P(AddedMass, of_a_sphere_that_is_let_go) {
  let_a_sphere_go(GetParam().across, GetParam().width, GetParam().density);
}
INSTANTIATE_TEST_SUITE_P(Long, AddedMass,
                         testing::Values(Sphere{0.06, 0.24, 2}, Sphere{0.06, 0.24, 0.5}, Sphere{0.12, 0.6, 2},
                                         Sphere{0.12, 0.6, 0.5}));

}  // namespace
}  // namespace oilskin::bullet
