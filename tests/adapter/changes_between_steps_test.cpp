// What a game changes between two steps does not move what stands, and is seen in the next one.
#include <gtest/gtest.h>

#include <functional>
#include <new>

#include "game.h"
#include "oilskin/bullet_emitter.h"
#include "oilskin/bullet_listener.h"

namespace oilskin::bullet {
namespace {

using namespace test;

btTransform at(double x, double y, double z) {
  return btTransform(btQuaternion::getIdentity(), {bt(x), bt(y), bt(z)});
}

double fastest(const btFluid& water) {
  double speed = 0;
  for (const Vec3& v : water.getWorld().velocities()) speed = std::max(speed, v.norm());
  return speed;
}

SurfaceSettings sticking() {
  SurfaceSettings settings;
  settings.thickness = 0.004;
  settings.slip.model = SlipModel::sticking;
  return settings;
}

WorldSettings large_world() {
  WorldSettings world = small_world();
  world.kill_box = {Vec3::Constant(-10), Vec3::Constant(10)};
  return world;
}

TEST(ChangesBetweenSteps, a_plane_stands_while_fluids_with_other_kill_boxes_come_and_go) {
  Game game;
  btStaticPlaneShape shape(btVector3(0, 1, 0), 0);
  btCollisionObject plane;
  plane.setCollisionShape(&shape);
  ASSERT_TRUE(game.solver.getCoupling().addCollisionObject(&plane, sticking()).ok());
  ASSERT_TRUE(game.pour(0).ok());
  game.run(100);
  ASSERT_GT(game.solver.getReport().contact.contacts, 0u);
  const double before = fastest(game.water);
  btFluid other(coarse_fluid(), large_world(), ContactSettings());
  ASSERT_TRUE(game.solver.addFluid(&other).ok());
  game.run(2);
  EXPECT_LT(fastest(game.water), before + 0.5) << "its corners move to the other box";
  game.solver.removeFluid(&other);
  game.run(2);
  EXPECT_LT(fastest(game.water), before + 0.5);
  EXPECT_EQ(game.solver.getReport().substeps, 1);
}

TEST(ChangesBetweenSteps, another_shape_at_the_address_of_the_old_one_is_seen) {
  Game game;
  alignas(btBoxShape) unsigned char memory[sizeof(btBoxShape)];
  auto* box = new (memory) btBoxShape(btVector3(bt(0.1), bt(0.1), bt(0.1)));
  btCollisionObject object;
  object.setCollisionShape(box);
  ASSERT_TRUE(game.solver.addCollisionObject(&object, bt(0.004)).ok());
  ASSERT_TRUE(game.pour(0.6).ok());
  game.run(1);
  box->~btBoxShape();
  box = new (memory) btBoxShape(btVector3(bt(0.1), bt(0.5), bt(0.1)));
  game.run(1);
  double top = 0;
  for (const Vec3& x : game.solver.getCoupling().getSurface(&object)->x_t1) top = std::max(top, x.y());
  EXPECT_NEAR(top, 0.5, 0.05);
  game.solver.removeCollisionObject(&object);
  box->~btBoxShape();
}

TEST(ChangesBetweenSteps, a_teleport_that_the_world_is_told_of_drags_nothing_along) {
  Game game;
  Plate plate;
  plate.object.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  ASSERT_TRUE(game.solver.getCoupling().addCollisionObject(&plate.object, sticking()).ok());
  ASSERT_TRUE(game.pour(0).ok());
  game.run(100);
  ASSERT_GT(game.solver.getReport().contact.contacts, 0u);
  const double before = fastest(game.water);
  plate.object.setWorldTransform(at(0.05, -0.02, 0));
  World& world = game.water.getWorld();
  world.reset_motion(game.solver.getCoupling().getSurfaceId(&plate.object));
  game.run(1);
  EXPECT_LT(fastest(game.water), before + 0.5);
}

TEST(ChangesBetweenSteps, an_emitter_that_was_not_placed_yet_is_so_after_a_restore) {
  Game game;
  btFluidDiscEmitter nozzle(bt(0.03), bt(1));
  ASSERT_TRUE(game.water.addEmitter(&nozzle).ok());
  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(game.solver.saveState(&saved).ok());
  std::uint64_t hash = 0;
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(nozzle.setWorldTransform(at(1, 0, 0)).ok());
    game.run(30);
    for (const Vec3& x : game.water.getWorld().positions()) EXPECT_GT(x.x(), 0.9);
    if (k == 0) hash = game.water.getWorld().state_hash();
    EXPECT_EQ(game.water.getWorld().state_hash(), hash);
    ASSERT_TRUE(game.solver.restoreState(saved).ok());
  }
}

class Destroyer : public btFluidListener {
 public:
  std::function<void(const btCollisionObject*)> at_touch;
  int splashes = 0;
  void touchBegan(const btCollisionObject* object, const btFluidTouch&) override { at_touch(object); }
  void splash(const btCollisionObject*, const btFluidTouch&) override { ++splashes; }
};

TEST(ChangesBetweenSteps, no_listener_hears_of_an_object_that_one_before_it_deleted) {
  Game game;
  Plate plate;
  auto object = std::make_unique<btCollisionObject>();
  object->setCollisionShape(&plate.shape);
  object->setWorldTransform(plate.object.getWorldTransform());
  game.bullet.world.addCollisionObject(object.get());
  game.solver.setCollisionWorld(&game.bullet.world);
  ASSERT_TRUE(game.solver.addCollisionObject(object.get(), bt(0.002)).ok());
  Destroyer listener;
  bool is_deleted = false;
  listener.at_touch = [&](const btCollisionObject*) {
    game.bullet.world.removeCollisionObject(object.get());
    object.reset();
    is_deleted = true;
  };
  ASSERT_TRUE(listener.setSplashThreshold(0).ok());
  ASSERT_TRUE(game.solver.addListener(&listener).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(150);
  EXPECT_TRUE(is_deleted);
  EXPECT_EQ(listener.splashes, 0) << "it was due with the touch";
}

TEST(ChangesBetweenSteps, a_sensor_keeps_its_counts_while_fluids_are_exchanged) {
  Game game;
  btBoxShape shape(btVector3(bt(0.2), bt(0.03), bt(0.2)));
  btCollisionObject sensor;
  sensor.setCollisionShape(&shape);
  sensor.setWorldTransform(at(0, -0.1, 0));
  sensor.setCollisionFlags(sensor.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
  ASSERT_TRUE(game.solver.addCollisionObject(&sensor, bt(0.002)).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(250);
  const btFluidReading* reading = game.solver.getCoupling().getReading(&sensor);
  const std::uint64_t entered = reading->m_flow.m_entered;
  ASSERT_GT(entered, 0u);
  btFluid other(coarse_fluid(), small_world(), ContactSettings());
  ASSERT_TRUE(game.solver.addFluid(&other).ok());
  game.solver.removeFluid(&game.water);
  EXPECT_EQ(game.solver.getCoupling().getReading(&sensor)->m_flow.m_entered, entered);
  game.solver.removeFluid(&other);
}

}  // namespace
}  // namespace oilskin::bullet
