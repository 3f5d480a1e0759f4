// Emitters that the user of Bullet owns.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "bullet_world.h"
#include "oilskin/bullet_emitter.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr double pi = 3.14159265358979323846;

WorldSettings weightless() {
  WorldSettings world = small_world();
  world.gravity.setZero();
  return world;
}

struct Water : btFluid {
  Water() : btFluid(coarse_fluid(), weightless(), ContactSettings()) {}
  void run(int steps, double dt = 0.004) {
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(getWorld().step(dt).status.ok());
  }
};

btTransform at(double x, double y, double z, double angle = 0) {
  return btTransform(btQuaternion(btVector3(0, 0, 1), bt(angle)), btVector3(bt(x), bt(y), bt(z)));
}

TEST(Emitter, a_box_of_whole_spacings_is_full_wherever_single_precision_puts_it) {
  for (const double dx : {0.02, 0.03, 0.04})
    for (double x = -40; x < 40; x += 1.731) {
      WorldSettings far = weightless();
      far.kill_box = {Vec3::Constant(-50), Vec3::Constant(50)};
      FluidSettings fluid = coarse_fluid();
      fluid.spacing = dx;
      btFluid water(fluid, far, ContactSettings());
      const btVector3 low(bt(x), bt(x), bt(x)), size(bt(7 * dx), bt(7 * dx), bt(7 * dx));
      ASSERT_TRUE(water.addBox(low, low + size).ok());
      ASSERT_TRUE(water.getWorld().step(1e-4).status.ok());
      ASSERT_EQ(water.getNumParticles(), 343) << dx << " at " << x;
    }
}

/// The order of the manual: a new emitter is put to its place after it was added.
TEST(Emitter, its_first_place_is_no_motion) {
  for (const bool is_added_first : {true, false}) {
    Water water;
    btFluidDiscEmitter hose(bt(0.03), bt(1));
    if (!is_added_first) {
      ASSERT_TRUE(hose.setWorldTransform(at(0, 0.4, 0)).ok());
    }
    ASSERT_TRUE(water.addEmitter(&hose).ok());
    if (is_added_first) {
      ASSERT_TRUE(hose.setWorldTransform(at(0, 0.4, 0)).ok());
    }
    water.run(10);
    ASSERT_GT(water.getNumParticles(), 0);
    for (int i = 0; i < water.getNumParticles(); ++i) EXPECT_GT(water.getPosition(i).y(), 0.3);
    ASSERT_TRUE(hose.setWorldTransform(at(0, -0.4, 0)).ok());
    water.run(1, 0.1);
    double lowest = 1;
    for (int i = 0; i < water.getNumParticles(); ++i)
      lowest = std::min(lowest, double(water.getPosition(i).y()));
    EXPECT_LT(lowest, 0.3) << "the next one is";
    water.removeEmitter(&hose);
  }
}

TEST(Emitter, a_hose_that_is_steered_in_each_frame_gives_what_is_asked) {
  Water water;
  btFluidDiscEmitter hose(bt(0.05), 2);
  ASSERT_TRUE(water.addEmitter(&hose).ok());
  EXPECT_EQ(hose.getFluid(), &water);
  double asked = 0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(hose.setWorldTransform(at(0.2 * std::sin(0.1 * k), 0.5, 0, 0.5 * std::cos(0.07 * k)),
                                       bt(k % 2 == 0 ? 0 : 0.01))
                    .ok());
    ASSERT_TRUE(hose.setSpeed(bt(2 + std::sin(0.05 * k))).ok());
    ASSERT_TRUE(hose.setEnabled(k % 60 < 45).ok());
    asked += hose.isEnabled() ? 0.01 * static_cast<double>(hose.getSpeed()) * pi * 0.05 * 0.05 : 0;
    water.run(2, 0.005);
    water.clear();
  }
  EXPECT_NEAR(static_cast<double>(hose.getEmittedVolume()) / asked, 1, 0.005);
}

TEST(Emitter, water_leaves_along_minus_y_of_the_frame_with_the_velocity_of_its_carrier) {
  Water water;
  btFluidDiscEmitter hose(bt(0.04), 3);
  ASSERT_TRUE(hose.setWorldTransform(at(0.1, 0.2, 0.3, 0.5 * pi)).ok()) << "before it is in a fluid";
  ASSERT_TRUE(hose.setInheritedVelocity({0, 0, 1}).ok());
  ASSERT_TRUE(water.addEmitter(&hose).ok());
  water.run(1);
  ASSERT_GT(water.getNumParticles(), 3);
  for (int i = 0; i < water.getNumParticles(); ++i)
    EXPECT_LT((water.getVelocity(i) - btVector3(3, 0, 1)).length(), bt(1e-5));
  ASSERT_TRUE(hose.teleport(at(-1, 0, 0)).ok());
  water.clear();
  water.run(20);
  ASSERT_GT(water.getNumParticles(), 10);
  for (int i = 0; i < water.getNumParticles(); ++i) EXPECT_LT(water.getPosition(i).x(), bt(-0.9));
}

TEST(Emitter, boxes_and_meshes_are_filled_once_where_they_stand) {
  Water water;
  btFluidBoxEmitter box(btVector3(bt(0.1), bt(0.04), bt(0.06)));
  btTriangleMesh triangles;
  const btVector3 a(bt(0.5), 0, 0), b(bt(0.8), 0, 0), c(bt(0.5), bt(0.3), 0), d(bt(0.5), 0, bt(0.3));
  for (const auto& t : {std::array<btVector3, 3>{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}})
    triangles.addTriangle(t[0], t[1], t[2]);
  btFluidMeshEmitter mesh(&triangles);
  btSphereShape ball(bt(0.1));
  btFluidMeshEmitter sphere(&ball);
  ASSERT_TRUE(box.setWorldTransform(at(-0.5, 0, 0, 0.5 * pi)).ok());
  ASSERT_TRUE(mesh.setWorldTransform(at(-0.5, 0.5, 0, 0)).ok());
  ASSERT_TRUE(sphere.setWorldTransform(at(0, -0.5, 0)).ok());
  for (btFluidEmitter* e : {static_cast<btFluidEmitter*>(&box), static_cast<btFluidEmitter*>(&mesh),
                            static_cast<btFluidEmitter*>(&sphere)}) {
    const Status s = water.addEmitter(e);
    ASSERT_TRUE(s.ok()) << s.message;
  }
  ASSERT_TRUE(sphere.setEnabled(false).ok());
  water.run(1);
  const double m = water.getWorld().particle_mass() / 1000;
  EXPECT_TRUE(box.hasEnded());
  EXPECT_NEAR(static_cast<double>(box.getEmittedVolume()), 10 * 4 * 6 * m, 1e-6 * m * 240);
  EXPECT_NEAR(static_cast<double>(mesh.getEmittedVolume()), 0.3 * 0.3 * 0.3 / 6, 0.12 * 0.0045);
  EXPECT_FALSE(sphere.hasEnded());
  EXPECT_EQ(sphere.getEmittedVolume(), 0);
  for (int i = 0; i < water.getNumParticles(); ++i) {
    const btVector3 x = water.getPosition(i);
    const bool in_box = std::abs(x.x() + bt(0.5)) < bt(0.04) && std::abs(x.y()) < bt(0.1);
    const bool in_mesh = x.x() >= bt(-1e-6) && x.y() >= bt(0.5 - 1e-6) && x.z() >= bt(-1e-6) &&
                         x.x() + x.y() + x.z() < bt(0.81);
    EXPECT_TRUE(in_box || in_mesh) << x.x() << " " << x.y() << " " << x.z();
  }
  water.clear();
  ASSERT_TRUE(sphere.setEnabled(true).ok());
  water.run(1);
  EXPECT_NEAR(static_cast<double>(sphere.getEmittedVolume()), 4.0 / 3 * pi * 1e-3, 0.05 * 4.2e-3);
}

TEST(Emitter, rain_falls_where_it_is_at_its_rate) {
  Water water;
  btFluidRainEmitter rain(bt(0.3), bt(0.2), 1000, 0, 2);
  ASSERT_TRUE(rain.setWorldTransform(at(0, 1, 0)).ok());
  ASSERT_TRUE(water.addEmitter(&rain).ok());
  water.run(50);
  ASSERT_TRUE(rain.setDropsPerSecond(2000).ok());
  EXPECT_EQ(rain.getDropsPerSecond(), 2000);
  water.run(50);
  EXPECT_NEAR(water.getNumParticles(), 600, 2);
  for (int i = 0; i < water.getNumParticles(); ++i) EXPECT_LE(std::abs(water.getPosition(i).z()), bt(0.2));
}

TEST(Emitter, either_of_emitter_and_fluid_may_be_deleted_first) {
  auto water = std::make_unique<Water>();
  btFluidDiscEmitter stays(bt(0.05), 2);
  std::optional<btFluidDiscEmitter> goes(std::in_place, bt(0.05), bt(2));
  ASSERT_TRUE(stays.setWorldTransform(at(0.5, 0, 0)).ok());
  ASSERT_TRUE(water->addEmitter(&stays).ok());
  ASSERT_TRUE(water->addEmitter(&*goes).ok());
  water->run(20);
  const double of_both = water->getNumParticles();
  goes.reset();
  water->run(20);
  EXPECT_LT(water->getNumParticles(), 1.6 * of_both);
  const btScalar volume = stays.getEmittedVolume();
  EXPECT_GT(volume, 0);
  water.reset();
  EXPECT_EQ(stays.getFluid(), nullptr);
  EXPECT_FALSE(stays.getEmitterId());
  EXPECT_EQ(stays.getEmittedVolume(), volume);
  EXPECT_TRUE(stays.setSpeed(1).ok());
  Water other;
  ASSERT_TRUE(other.addEmitter(&stays).ok());
  other.run(20);
  EXPECT_GT(stays.getEmittedVolume(), volume);
  other.removeEmitter(&stays);
  other.removeEmitter(&stays);
  const int before = other.getNumParticles();
  other.run(20);
  EXPECT_EQ(other.getNumParticles(), before);
}

TEST(Emitter, what_makes_no_sense_is_refused_in_words) {
  Water water, other;
  const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
  const auto refused = [](const Status& s, const char* word) {
    EXPECT_NE(s.message.find(word), std::string::npos) << s.message;
  };
  btFluidDiscEmitter hose(bt(0.05), 2), thin(bt(0.001)), backward(bt(0.05), -1);
  refused(water.addEmitter(nullptr), "null");
  refused(water.addEmitter(&thin), "radius");
  refused(water.addEmitter(&backward), "speed");
  EXPECT_EQ(thin.getFluid(), nullptr);
  refused(hose.setSpeed(nan), "speed");
  refused(hose.setInheritedVelocity({0, nan, 0}), "not finite");
  refused(hose.setWorldTransform(at(0, static_cast<double>(nan), 0)), "not finite");
  refused(hose.setWorldTransform(btTransform(btMatrix3x3(2, 0, 0, 0, 2, 0, 0, 0, 2))), "scales");
  refused(hose.setWorldTransform(at(0, 0, 0), -1), "duration");
  refused(hose.setWorldTransform(at(0, 0, 0), nan), "duration");
  refused(hose.teleport(btTransform(btMatrix3x3(-1, 0, 0, 0, 1, 0, 0, 0, 1))), "mirrors");
  ASSERT_TRUE(water.addEmitter(&hose).ok());
  refused(hose.setWorldTransform(at(0, 0, 0), -1), "duration");
  refused(hose.setSpeed(-2), "speed");
  EXPECT_EQ(hose.getSpeed(), 2);
  refused(water.addEmitter(&hose), "already");
  refused(other.addEmitter(&hose), "another fluid");
  btFluidDiscEmitter far(bt(0.05));
  ASSERT_TRUE(far.setWorldTransform(at(50, 0, 0)).ok());
  refused(water.addEmitter(&far), "kill box");
  btFluidMeshEmitter none(static_cast<const btCollisionShape*>(nullptr));
  refused(water.addEmitter(&none), "null");
  btTriangleMesh empty;
  btFluidMeshEmitter hollow(&empty);
  refused(water.addEmitter(&hollow), "no triangles");
  btFluidRainEmitter rain(1, 1, 100);
  refused(rain.setDropsPerSecond(0), "drops per second");
  btFluidRainEmitter turned(-1, 1, 100);
  refused(water.addEmitter(&turned), "halfX");
}

}  // namespace
}  // namespace oilskin::bullet
