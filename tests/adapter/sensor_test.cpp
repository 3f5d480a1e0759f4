// Sensors: attached objects without contact response measure the water and do not stop it.
#include <gtest/gtest.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <random>

#include "bullet_adapter/shape_region.h"
#include "game.h"
#include "oilskin/bullet_listener.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr int no_response = btCollisionObject::CF_NO_CONTACT_RESPONSE;

/// A box of 0.3 × 0.06 × 0.3 m around (0, y, 0) that measures.
struct BoxSensor {
  btBoxShape shape{btVector3(bt(0.15), bt(0.03), bt(0.15))};
  btGhostObject object;

  explicit BoxSensor(double y) {
    object.setCollisionShape(&shape);
    object.setCollisionFlags(object.getCollisionFlags() | no_response);
    place(y);
  }
  void place(double y) { object.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, bt(y), 0})); }
  std::uint64_t count(const btFluid& water) const {
    std::uint64_t inside = 0;
    const Vec3 center = to_vec3(object.getWorldTransform().getOrigin());
    const Vec3 half = to_vec3(shape.getHalfExtentsWithMargin());
    for (const Vec3& x : water.getWorld().positions())
      inside += ((x - center).cwiseAbs().array() <= half.array()).all();
    return inside;
  }
};

std::uint64_t balance(const btFluidReading& r) {
  const btFluidFlow& f = r.m_flow;
  return f.m_entered - f.m_left + f.m_appeared - f.m_vanished;
}

class FlowDiary : public btFluidListener {
 public:
  btFluidFlow entered, left;
  int calls = 0;
  void waterEntered(const btCollisionObject*, const btFluidFlow& flow) override {
    ++calls;
    entered += flow;
    EXPECT_GT(flow.m_entered, 0u);
  }
  void waterLeft(const btCollisionObject*, const btFluidFlow& flow) override {
    ++calls;
    left += flow;
    EXPECT_GT(flow.m_left, 0u);
  }
};

TEST(Sensor, counts_exactly_what_falls_through_and_stops_nothing) {
  Game game;
  BoxSensor sensor(-0.1);
  FlowDiary diary;
  ASSERT_TRUE(game.solver.addCollisionObject(&sensor.object, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  EXPECT_EQ(game.water.getWorld().surface_count(), 0u);
  ASSERT_TRUE(game.pour().ok());
  const btFluidReading* reading = game.solver.getCoupling().getReading(&sensor.object);
  ASSERT_NE(reading, nullptr);
  std::uint64_t most = 0;
  for (int i = 0; i < 260; ++i) {
    game.run(1);
    reading = game.solver.getCoupling().getReading(&sensor.object);
    ASSERT_EQ(reading->m_particles, sensor.count(game.water)) << "step " << i;
    ASSERT_EQ(reading->m_particles, balance(*reading)) << "step " << i;
    most = std::max(most, reading->m_particles);
  }
  const auto all = static_cast<std::uint64_t>(game.water.getNumParticles());
  ASSERT_GT(all, 100u);
  EXPECT_GT(most, all / 4);
  EXPECT_EQ(reading->m_flow.m_entered, all);
  EXPECT_EQ(reading->m_flow.m_left, all);
  EXPECT_NEAR(reading->m_flow.m_enteredVolume, static_cast<double>(game.water.getVolume()), 1e-6);
  EXPECT_EQ(reading->m_volume, 0);
  EXPECT_EQ(diary.entered.m_entered, all);
  EXPECT_EQ(diary.left.m_left, all);
  EXPECT_LT(diary.calls, 400) << "one call a step at most, of each kind";
}

TEST(Sensor, a_particle_that_passes_within_one_step_is_counted) {
  Game game;
  BoxSensor sensor(-0.1);
  ASSERT_TRUE(game.solver.addCollisionObject(&sensor.object, bt(0.002)).ok());
  const std::vector<Vec3> x = {{0, 0, 0}, {0.1, 0, 0}, {0.5, 0, 0}};
  const std::vector<Vec3> v = {{0, -400, 0}, {0, -100, 0}, {0, -400, 0}};
  ASSERT_TRUE(game.water.getWorld().add_particles(x, v).ok());
  game.run(1);  // to −0.4, into the box, and past it
  const btFluidReading* reading = game.solver.getCoupling().getReading(&sensor.object);
  ASSERT_NE(reading, nullptr);
  EXPECT_EQ(reading->m_flow.m_passed, 1u);
  EXPECT_EQ(reading->m_flow.m_entered, 2u);
  EXPECT_EQ(reading->m_flow.m_left, 1u);
  EXPECT_EQ(reading->m_particles, 1u);
}

TEST(Sensor, its_own_motion_counts_and_a_teleport_does_not) {
  Game game;
  game.bullet.world.getWorldInfo().m_gravity.setZero();
  ASSERT_TRUE(game.water.setGravity({0, 0, 0}).ok());
  ASSERT_TRUE(game.pour(0).ok());
  game.run(1);
  const auto all = static_cast<std::uint64_t>(game.water.getNumParticles());
  BoxSensor sensor(0.4);
  ASSERT_TRUE(game.solver.addCollisionObject(&sensor.object, bt(0.002)).ok());
  btFluidCoupling& coupling = game.solver.getCoupling();
  game.run(1);
  EXPECT_EQ(coupling.getReading(&sensor.object)->m_flow.m_entered, 0u);
  sensor.place(-0.4);
  game.run(1);
  EXPECT_EQ(coupling.getReading(&sensor.object)->m_flow.m_passed, all) << "swept over the water";
  sensor.place(0.04);
  coupling.resetMotion(&sensor.object);
  game.run(1);
  const btFluidReading reading = *coupling.getReading(&sensor.object);
  EXPECT_EQ(reading.m_flow.m_entered, all);
  EXPECT_GT(reading.m_flow.m_appeared, 0u);
  EXPECT_EQ(reading.m_particles, reading.m_flow.m_appeared);
  game.water.clear();
  game.run(1);
  EXPECT_EQ(coupling.getReading(&sensor.object)->m_flow.m_vanished, reading.m_flow.m_appeared);
  EXPECT_EQ(coupling.getReading(&sensor.object)->m_particles, 0u);
}

TEST(Sensor, water_inside_at_first_did_not_enter) {
  Game game;
  ASSERT_TRUE(game.pour(-0.04).ok());
  game.run(1);
  BoxSensor sensor(0);
  ASSERT_TRUE(game.solver.addCollisionObject(&sensor.object, bt(0.002)).ok());
  game.run(1);
  const btFluidReading* reading = game.solver.getCoupling().getReading(&sensor.object);
  EXPECT_EQ(reading->m_flow.m_entered + reading->m_flow.m_appeared, 0u);
  EXPECT_EQ(reading->m_particles, sensor.count(game.water));
  EXPECT_GT(reading->m_particles, 50u);
  EXPECT_NEAR(reading->m_volume,
              static_cast<double>(reading->m_particles) * game.water.getWorld().particle_mass() / 1000, 1e-9);
}

TEST(Sensor, the_flag_may_change_while_it_is_attached) {
  Game game;
  Plate plate;
  ASSERT_TRUE(game.solver.addCollisionObject(&plate.object, bt(0.002)).ok());
  ASSERT_TRUE(game.pour(0.01).ok());
  const auto lowest = [&] {
    double y = 1;
    for (const Vec3& x : game.water.getWorld().positions()) y = std::min(y, x.y());
    return y;
  };
  game.run(60);
  EXPECT_GT(lowest(), 0);
  EXPECT_EQ(game.solver.getCoupling().getReading(&plate.object), nullptr);
  plate.object.setCollisionFlags(plate.object.getCollisionFlags() | no_response);
  game.run(60);
  EXPECT_LT(lowest(), -0.01);
  const btFluidReading* reading = game.solver.getCoupling().getReading(&plate.object);
  ASSERT_NE(reading, nullptr);
  EXPECT_GT(reading->m_particles, 0u);
  EXPECT_EQ(game.water.getWorld().surface_count(), 0u);
  plate.object.setCollisionFlags(plate.object.getCollisionFlags() & ~no_response);
  game.run(1);
  EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
  EXPECT_EQ(game.solver.getCoupling().getReading(&plate.object), nullptr);
  EXPECT_TRUE(game.solver.getReport().status.ok());
  game.run(20);
  EXPECT_EQ(game.messages(), "");
}

TEST(Sensor, shapes_without_a_volume_are_refused_in_words) {
  Game game;
  btStaticPlaneShape plane({0, 1, 0}, 0);
  BoxSensor sensor(0);
  sensor.object.setCollisionShape(&plane);
  const Status status = game.solver.addCollisionObject(&sensor.object, bt(0.002));
  ASSERT_FALSE(status.ok());
  EXPECT_TRUE(has(status.message, "a shape with a volume")) << status.message;
  EXPECT_EQ(game.solver.getCoupling().getReading(&sensor.object), nullptr);
  EXPECT_EQ(game.solver.getCoupling().getReading(nullptr), nullptr);

  Plate plate;
  plate.object.setCollisionShape(&plane);
  ASSERT_TRUE(game.solver.addCollisionObject(&plate.object, bt(0.002)).ok());
  plate.object.setCollisionFlags(plate.object.getCollisionFlags() | no_response);
  game.run(2);
  EXPECT_TRUE(has(game.messages(), "a shape with a volume"));
}

TEST(Sensor, a_dynamic_body_may_measure) {
  Game game;
  btBoxShape shape({bt(0.1), bt(0.1), bt(0.1)});
  btRigidBody body(bt(1), nullptr, &shape, {1, 1, 1});
  body.setCollisionFlags(body.getCollisionFlags() | no_response);
  ASSERT_TRUE(game.solver.addCollisionObject(&body, bt(0.002)).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(30);
  EXPECT_GT(game.solver.getCoupling().getReading(&body)->m_particles, 50u);
  body.setCollisionFlags(body.getCollisionFlags() & ~no_response);
  game.run(1);
  EXPECT_EQ(game.water.getWorld().surface_count(), 0u);
  EXPECT_TRUE(has(game.messages(), "a sensor no longer"));
}

TEST(Sensor, another_fluid_starts_a_new_count) {
  Game game;
  BoxSensor sensor(0.05);
  ASSERT_TRUE(game.solver.addCollisionObject(&sensor.object, bt(0.002)).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(5);
  EXPECT_GT(game.solver.getCoupling().getReading(&sensor.object)->m_particles, 0u);
  game.solver.removeFluid(&game.water);
  EXPECT_EQ(game.solver.getCoupling().getReading(&sensor.object)->m_particles, 0u);
  btFluid other(coarse_fluid(), small_world(), ContactSettings{});
  ASSERT_TRUE(game.solver.addFluid(&other).ok());
  game.run(1);
  EXPECT_EQ(game.solver.getCoupling().getReading(&sensor.object)->m_flow.m_vanished, 0u);
  game.solver.removeFluid(&other);
}

/// Dense points of a segment find each crossing but the shortest; and each found one is a crossing.
TEST(ShapeRegion, a_segment_meets_a_shape_where_its_points_are_inside) {
  btSphereShape sphere(bt(0.5));
  btCapsuleShape capsule(bt(0.3), bt(0.8));
  btBoxShape box({bt(0.5), bt(0.3), bt(0.4)});
  btCylinderShape cylinder({bt(0.4), bt(0.5), bt(0.4)});
  btCompoundShape compound;
  compound.addChildShape(btTransform(btQuaternion({0, 0, 1}, bt(0.7)), {bt(0.3), 0, 0}), &box);
  compound.addChildShape(btTransform(btQuaternion::getIdentity(), {bt(-0.6), 0, 0}), &sphere);
  std::mt19937 random(7);
  const auto coordinate = [&] { return static_cast<double>(random() % 2401) / 1000 - 1.2; };
  const auto point = [&] {
    const double x = coordinate(), y = coordinate();
    return Vec3(x, y, coordinate());
  };
  const std::initializer_list<const btCollisionShape*> shapes = {&sphere, &capsule, &box, &cylinder,
                                                                 &compound};
  for (const btCollisionShape* shape : shapes) {
    const auto region = ShapeRegion::of(*shape);
    ASSERT_TRUE(region);
    int met = 0;
    for (int k = 0; k < 300; ++k) {
      const Vec3 a = point(), b = point();
      constexpr int parts = 2000;
      int inside = 0, parts_met = 0;
      const auto at = [&](int i) { return Vec3(a + (b - a) * i / parts); };
      for (int i = 0; i < parts; ++i) {
        inside += region->contains(at(i));
        parts_met += region->meets(at(i), at(i + 1));
      }
      const bool meets = region->meets(a, b);
      met += meets;
      EXPECT_TRUE(meets || inside == 0) << shape->getName() << k;
      EXPECT_EQ(meets, parts_met > 0) << shape->getName() << k;
      EXPECT_LE(std::abs(parts_met - inside), 4) << shape->getName() << k;
    }
    EXPECT_GT(met, 30);
    EXPECT_LT(met, 270);
  }
  btStaticPlaneShape plane({0, 1, 0}, 0);
  EXPECT_FALSE(ShapeRegion::of(plane));
  btCompoundShape empty;
  EXPECT_FALSE(ShapeRegion::of(empty));
}

}  // namespace
}  // namespace oilskin::bullet
