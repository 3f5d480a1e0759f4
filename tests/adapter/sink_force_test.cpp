// Sinks and force fields that the user owns.
#include <gtest/gtest.h>

#include <memory>

#include "bullet_world.h"
#include "convert.h"
#include "oilskin/bullet_force.h"
#include "oilskin/bullet_sink.h"
#include "support/random.h"

namespace oilskin::bullet {
namespace {

using namespace test;

FluidSettings coarse() {
  FluidSettings f;
  f.spacing = 0.01;
  return f;
}

WorldSettings weightless() {
  WorldSettings w = small_world();
  w.gravity.setZero();
  return w;
}

/// A fluid without gravity in a coupling.
struct Water {
  Water() : fluid(coarse(), weightless(), ContactSettings()), coupling(&fluid) {}
  void step(double dt = 1e-3) {
    const StepReport& r = coupling.step(bt(dt));
    ASSERT_TRUE(r.status.ok()) << r.status.message;
  }
  void add(const std::vector<Vec3>& x) {
    EXPECT_TRUE(fluid.getWorld().add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  }
  btFluid fluid;
  btFluidCoupling coupling;
};

btTransform turned(const btVector3& at) {
  return btTransform(btQuaternion(btVector3(0, 0, 1), bt(0.5)), at);
}

/// What btFluid::removeParticles() takes, a sink takes.
TEST(BulletSink, takes_the_particles_in_its_shape) {
  btConvexHullShape hull;
  for (int c = 0; c < 8; ++c)
    hull.addPoint(btVector3(bt(c & 1 ? 0.2 : -0.2), bt(c & 2 ? 0.1 : -0.1), bt(c & 4 ? 0.15 : -0.05)));
  btBoxShape box(btVector3(bt(0.2), bt(0.1), bt(0.1)));
  btSphereShape sphere(bt(0.15));
  btCapsuleShape capsule(bt(0.1), bt(0.2));
  btCylinderShape cylinder(btVector3(bt(0.1), bt(0.2), bt(0.1)));
  oilskin::test::Random random(1);
  std::vector<Vec3> x(2000);
  for (Vec3& at : x) at = random.in_cube(0.4);
  const btConvexShape* shapes[] = {&hull, &box, &sphere, &capsule, &cylinder};
  for (const btConvexShape* shape : shapes) {
    Water with, without;
    with.add(x), without.add(x);
    btFluidSink sink(shape);
    const btTransform place = turned(btVector3(bt(0.05), bt(-0.02), 0));
    ASSERT_TRUE(sink.setWorldTransform(place).ok());
    ASSERT_TRUE(with.fluid.addSink(&sink).ok());
    with.step(1e-9);  // nothing moves in it
    const int removed = without.fluid.removeParticles(shape, place);
    EXPECT_GT(removed, 20);
    EXPECT_NEAR(static_cast<double>(sink.getTakenParticles()), removed, 2) << shape->getName();
    EXPECT_EQ(static_cast<std::uint64_t>(with.fluid.getNumParticles()), x.size() - sink.getTakenParticles());
    EXPECT_NEAR(double(sink.getTakenVolume()),
                double(sink.getTakenParticles()) * with.fluid.getWorld().particle_mass() / 1000, 1e-6);
  }
}

TEST(BulletSink, can_be_moved_switched_and_deleted_before_or_after_its_fluid) {
  btBoxShape box(btVector3(bt(0.05), bt(0.05), bt(0.05)));
  auto sink = std::make_unique<btFluidSink>(&box);
  {
    Water w;
    ASSERT_TRUE(w.fluid.addSink(sink.get()).ok());
    EXPECT_EQ(sink->getFluid(), &w.fluid);
    EXPECT_TRUE(sink->getSinkId());
    w.add({Vec3(0.2, 0, 0), Vec3(0, 0, 0)});
    ASSERT_TRUE(sink->setEnabled(false).ok());
    w.step();
    EXPECT_EQ(w.fluid.getNumParticles(), 2);
    ASSERT_TRUE(sink->setEnabled(true).ok());
    ASSERT_TRUE(sink->setWorldTransform(turned(btVector3(bt(0.2), 0, 0))).ok());
    EXPECT_NEAR(double(sink->getWorldTransform().getOrigin().x()), 0.2, 1e-6);
    w.step();
    EXPECT_EQ(w.fluid.getNumParticles(), 1);
    EXPECT_EQ(w.coupling.getReport().removed_by_sinks, 1u);
  }
  EXPECT_EQ(sink->getFluid(), nullptr);
  EXPECT_EQ(sink->getTakenParticles(), 1u) << "it stays readable";
  Water other;
  ASSERT_TRUE(other.fluid.addSink(sink.get()).ok());
  other.add({Vec3(0.2, 0, 0)});
  other.step();
  EXPECT_EQ(sink->getTakenParticles(), 2u);
  sink.reset();
  other.add({Vec3(0.2, 0, 0)});
  other.step();
  EXPECT_EQ(other.fluid.getNumParticles(), 1);
}

TEST(BulletSink, ages_end_particles) {
  Water w;
  ASSERT_TRUE(w.fluid.setMaxAge(bt(0.01)).ok());
  w.add({Vec3(0, 0, 0)});
  for (int k = 0; k < 9; ++k) w.step();
  EXPECT_EQ(w.fluid.getNumParticles(), 1);
  for (int k = 0; k < 2; ++k) w.step();
  EXPECT_EQ(w.fluid.getNumParticles(), 0);
  EXPECT_FALSE(w.fluid.setMaxAge(0).ok());
}

void expect_refusal(const Status& status, const char* word) {
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message.find(word), std::string::npos) << status.message;
}

TEST(BulletSink, what_makes_no_sense_is_refused_in_words) {
  Water w, other;
  btBoxShape box(btVector3(bt(0.05), bt(0.05), bt(0.05)));
  btFluidSink sink(&box), none(nullptr);
  expect_refusal(w.fluid.addSink(nullptr), "null");
  expect_refusal(w.fluid.addSink(&none), "null");
  ASSERT_TRUE(w.fluid.addSink(&sink).ok());
  expect_refusal(w.fluid.addSink(&sink), "already");
  expect_refusal(other.fluid.addSink(&sink), "another fluid");
  btTransform scaled = btTransform::getIdentity();
  scaled.getBasis() = scaled.getBasis().scaled(btVector3(2, 2, 2));
  expect_refusal(sink.setWorldTransform(scaled), "scales");
  expect_refusal(sink.setWorldTransform(turned(btVector3(bt(NAN), 0, 0))), "not finite");
  EXPECT_EQ(sink.getWorldTransform().getOrigin(), btVector3(0, 0, 0));
  btSphereShape point(0);
  btFluidSink empty(&point);
  expect_refusal(w.fluid.addSink(&empty), "radius");
}

TEST(BulletForce, fields_accelerate_and_end_with_their_owners) {
  auto w = std::make_unique<Water>();
  btFluidUniformForce push(btVector3(1, 0, 0));
  auto whirl = std::make_unique<btFluidVortex>(btVector3(0, 0, 0), btVector3(0, 1, 0), bt(0.1), bt(2));
  w->add({Vec3(0, 0, 0.05)});
  const std::uint64_t before = w->fluid.getWorld().state_hash();
  ASSERT_TRUE(w->fluid.addForce(&push).ok());
  ASSERT_TRUE(w->fluid.addForce(whirl.get()).ok());
  EXPECT_EQ(w->fluid.getWorld().state_hash(), before);
  const auto gained = [&] {
    const double start = w->fluid.getWorld().velocities()[0].x();
    w->step();
    return (w->fluid.getWorld().velocities()[0].x() - start) / 1e-3;
  };
  EXPECT_NEAR(gained(), 1 + 1, 1e-4);  // half of the radius
  ASSERT_TRUE(push.setAcceleration(btVector3(3, 0, 0)).ok());
  EXPECT_EQ(push.getAcceleration(), btVector3(3, 0, 0));
  ASSERT_TRUE(whirl->setStrength(4).ok());
  EXPECT_NEAR(gained(), 3 + 2, 1e-3);
  ASSERT_TRUE(push.setEnabled(false).ok());
  EXPECT_NEAR(gained(), 2, 1e-3);
  whirl.reset();
  ASSERT_TRUE(push.setEnabled(true).ok());
  btSphereShape ball(bt(0.1));
  ASSERT_TRUE(push.setRegion(&ball, turned(btVector3(bt(0.5), 0, 0))).ok());
  EXPECT_NEAR(gained(), 0, 1e-6);
  ASSERT_TRUE(push.setRegion(nullptr).ok());
  EXPECT_NEAR(gained(), 3, 1e-3);
  w.reset();
  EXPECT_EQ(push.getFluid(), nullptr);
  EXPECT_EQ(push.getAcceleration(), btVector3(3, 0, 0));
}

TEST(BulletForce, wind_takes_a_drop_along) {
  Water w;
  btFluidWind wind(btVector3(10, 0, 0));
  ASSERT_TRUE(wind.setAir(bt(1000), 1, 0).ok());
  ASSERT_TRUE(w.fluid.addForce(&wind).ok());
  w.add({Vec3(0, 0, 0)});
  for (int k = 0; k < 20; ++k) w.step();
  const double speed = w.fluid.getWorld().velocities()[0].x();
  EXPECT_GT(speed, 5);
  EXPECT_LT(speed, 10);
  w.fluid.removeForce(&wind);
  w.step();
  EXPECT_EQ(w.fluid.getWorld().velocities()[0].x(), speed);
}

TEST(BulletForce, what_makes_no_sense_is_refused_in_words) {
  Water w, other;
  btFluidUniformForce push;
  btFluidVortex flat(btVector3(0, 0, 0), btVector3(0, 0, 0), 1, 1);
  btFluidWind wind;
  expect_refusal(w.fluid.addForce(nullptr), "null");
  expect_refusal(w.fluid.addForce(&flat), "axis");
  ASSERT_TRUE(w.fluid.addForce(&push).ok());
  expect_refusal(w.fluid.addForce(&push), "already");
  expect_refusal(other.fluid.addForce(&push), "another fluid");
  expect_refusal(push.setAcceleration(btVector3(bt(NAN), 0, 0)), "acceleration");
  expect_refusal(wind.setVelocity(btVector3(bt(INFINITY), 0, 0)), "velocity");
  expect_refusal(wind.setAir(-1, 1, 1), "air_density");
  expect_refusal(flat.setStrength(bt(NAN)), "axis");
  btTransform scaled = btTransform::getIdentity();
  scaled.getBasis() = scaled.getBasis().scaled(btVector3(2, 2, 2));
  expect_refusal(push.setRegion(nullptr, scaled), "scales");
}

TEST(BulletForce, the_saved_state_of_a_coupling_has_sinks_and_forces) {
  Water w;
  btBoxShape box(btVector3(bt(0.05), bt(0.05), bt(0.05)));
  btFluidSink sink(&box);
  btFluidUniformForce push(btVector3(1, 0, 0));
  ASSERT_TRUE(w.fluid.addSink(&sink).ok());
  ASSERT_TRUE(w.fluid.addForce(&push).ok());
  w.add({Vec3(0, 0, 0), Vec3(0.2, 0, 0)});
  w.step();
  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(w.coupling.saveState(&saved).ok());
  ASSERT_TRUE(push.setAcceleration(btVector3(5, 0, 0)).ok());
  ASSERT_TRUE(sink.setWorldTransform(turned(btVector3(bt(0.2), 0, 0))).ok());
  w.step();
  EXPECT_EQ(w.fluid.getNumParticles(), 0);
  const Status restored = w.coupling.restoreState(saved);
  ASSERT_TRUE(restored.ok()) << restored.message;
  EXPECT_EQ(w.fluid.getNumParticles(), 1);
  EXPECT_EQ(push.getAcceleration(), btVector3(1, 0, 0));
  EXPECT_EQ(sink.getWorldTransform().getOrigin(), btVector3(0, 0, 0));
  EXPECT_EQ(sink.getTakenParticles(), 1u);
}

}  // namespace
}  // namespace oilskin::bullet
