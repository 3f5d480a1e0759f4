// What a game hears: touches, splashes, reports of all sub-steps; and what it may do meanwhile.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "game.h"
#include "oilskin/bullet_listener.h"

namespace oilskin::bullet {
namespace {

using namespace test;

/// Writes down what it hears, and then does what the test wants.
class Diary : public btFluidListener {
 public:
  int begun = 0, ended = 0, splashes = 0, steps = 0;
  btFluidTouch last;
  Vec3 impulse = Vec3::Zero();  // of splashes
  StepReport sum;
  std::ostringstream order;
  std::function<void(const btCollisionObject*)> at_touch, at_splash;
  std::function<void()> at_step;

  void touchBegan(const btCollisionObject* object, const btFluidTouch& touch) override {
    ++begun;
    write('b', object, touch);
    if (at_touch) at_touch(object);
  }
  void touchEnded(const btCollisionObject* object) override {
    ++ended;
    write('e', object, {});
  }
  void splash(const btCollisionObject* object, const btFluidTouch& touch) override {
    ++splashes;
    impulse += to_vec3(touch.m_impulse);
    last = touch;
    write('s', object, touch);
    if (at_splash) at_splash(object);
  }
  void stepped(const StepReport& report) override {
    ++steps;
    sum.add(report);
    if (at_step) at_step();
  }

 private:
  void write(char kind, const btCollisionObject* object, const btFluidTouch& touch) {
    order << '\n'
          << kind << object->getUserIndex() << ' ' << std::hexfloat << touch.m_impulse.y() << ' '
          << touch.m_place.x() << ' ' << touch.m_area;
  }
};

TEST(Listener, touch_begins_once_and_does_not_flicker_at_rest) {
  Game game;
  Tank tank;
  Diary diary;
  ASSERT_TRUE(game.solver.addCollisionObject(&tank.object, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(20);
  EXPECT_EQ(diary.begun, 0) << "the water still falls";
  game.run(600);
  EXPECT_EQ(diary.begun, 1);
  EXPECT_EQ(diary.ended, 0);
  EXPECT_EQ(diary.steps, 620);
  game.water.clear();
  game.run(99);
  EXPECT_EQ(diary.ended, 0) << "held for 0.1 s";
  game.run(3);
  EXPECT_EQ(diary.ended, 1);
  ASSERT_TRUE(game.pour().ok());
  game.run(200);
  EXPECT_EQ(diary.begun, 2);
}

TEST(Listener, impulse_place_and_area_are_those_of_the_water) {
  Game game;
  Tank tank;
  Diary diary;
  ASSERT_TRUE(diary.setSplashThreshold(0).ok());
  ASSERT_TRUE(game.solver.addCollisionObject(&tank.object, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(400);
  btVector3 linear, angular;
  ASSERT_TRUE(game.solver.getCoupling().takeImpulse(&tank.object, linear, angular));
  EXPECT_NEAR((diary.impulse - to_vec3(linear)).norm(), 0, 1e-5 * to_vec3(linear).norm());
  // All that gravity gave and the water does not have now went into the tank.
  const StepReport& sum = diary.sum;
  const Vec3 given = sum.momentum_gravity + sum.momentum_emitted - sum.momentum_after;
  EXPECT_NEAR((given - to_vec3(linear)).norm(), 0, 1e-4 * given.norm());
  EXPECT_LT(given.y(), -1);

  ASSERT_TRUE(game.solver.getCoupling().takeImpulse(&tank.object, linear, angular));
  EXPECT_EQ(linear, btVector3(0, 0, 0)) << "taken";
  EXPECT_NEAR(static_cast<double>(diary.last.m_place.x()), 0, 0.06);
  EXPECT_NEAR(static_cast<double>(diary.last.m_place.z()), 0, 0.06);
  EXPECT_NEAR(static_cast<double>(diary.last.m_timeStep), 0.001, 1e-9);
  // The floor of 0.2 m × 0.2 m, and less than all walls up to the height of the block.
  EXPECT_GT(diary.last.m_area, bt(0.2 * 0.2 * 0.4));
  EXPECT_LT(diary.last.m_area, bt(0.2 * 0.2 + 4 * 0.2 * 0.08));
}

TEST(Listener, place_is_where_a_jet_hits) {
  Game game;
  Plate plate;
  Diary diary;
  ASSERT_TRUE(diary.setSplashThreshold(0).ok());
  ASSERT_TRUE(game.solver.addCollisionObject(&plate.object, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  ASSERT_TRUE(game.water.addJet({bt(0.11), bt(0.1), bt(-0.07)}, {0, -1, 0}, 2, bt(0.03)).ok());
  Vec3 moment = Vec3::Zero();
  double weight = 0;
  diary.at_splash = [&](const btCollisionObject*) {
    const double size = to_vec3(diary.last.m_impulse).norm();
    weight += size;
    moment += size * to_vec3(diary.last.m_place);
  };
  game.run(100);
  ASSERT_GT(weight, 0);
  moment /= weight;
  EXPECT_NEAR(moment.x(), 0.11, 0.015);
  EXPECT_NEAR(moment.y(), 0, 0.01);
  EXPECT_NEAR(moment.z(), -0.07, 0.015);
}

TEST(Listener, splash_is_above_the_threshold_only) {
  Game game;
  Plate plate;
  Diary all, large;
  ASSERT_TRUE(all.setSplashThreshold(0).ok());
  btScalar largest = 0;
  all.at_splash = [&](const btCollisionObject*) {
    largest = std::max(largest, all.last.m_impulse.length());
    EXPECT_GT(all.last.m_impulse.length(), 0);
  };
  const btScalar threshold = bt(0.1);
  ASSERT_TRUE(large.setSplashThreshold(threshold).ok());
  large.at_splash = [&](const btCollisionObject*) { EXPECT_GT(large.last.m_impulse.length(), threshold); };
  Diary none;
  ASSERT_TRUE(game.solver.addCollisionObject(&plate.object, bt(0.002)).ok());
  for (Diary* diary : {&all, &large, &none}) ASSERT_TRUE(game.solver.addListener(diary).ok());
  ASSERT_TRUE(game.pour(0.1).ok());
  game.run(250);
  EXPECT_GT(largest, threshold);
  EXPECT_GT(large.splashes, 0);
  EXPECT_LT(large.splashes, all.splashes);
  EXPECT_EQ(none.splashes, 0);
}

TEST(Listener, nothing_of_an_earlier_sub_step_is_lost) {
  Game game;
  Plate plate;
  Diary diary;
  ASSERT_TRUE(game.solver.addCollisionObject(&plate.object, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  ASSERT_TRUE(game.pour(0.01).ok());
  for (int frame = 0; frame < 5; ++frame) game.bullet.world.stepSimulation(bt(1. / 60), 20, bt(1. / 960));
  EXPECT_EQ(diary.steps, 5 * 16);
  const StepReport taken = game.solver.takeReport();
  EXPECT_EQ(taken.emitted, game.water.getWorld().particle_count());
  EXPECT_EQ(taken.emitted, diary.sum.emitted);
  EXPECT_EQ(taken.contact.impulse_on_prescribed, diary.sum.contact.impulse_on_prescribed);
  EXPECT_NEAR(taken.dt, 5. / 60, 1e-6);
  EXPECT_LT(taken.momentum_residual().norm(), 1e-6);
  EXPECT_EQ(game.solver.takeReport().emitted, 0u) << "taken";
}

TEST(Listener, the_order_does_not_depend_on_the_number_of_threads) {
  const auto hear = [](int threads) {
    Game game(threads);
    Plate plates[3] = {Plate(0.0), Plate(-0.3), Plate(-0.6)};
    Diary diary;
    EXPECT_TRUE(diary.setSplashThreshold(0).ok());
    for (int i = 0; i < 3; ++i) {
      plates[i].object.setUserIndex(i);
      EXPECT_TRUE(game.solver.addCollisionObject(&plates[i].object, bt(0.002)).ok());
    }
    btSoftBody* cloth = game.bullet.patch(9, 0.3, 0.02, 15);
    cloth->setUserIndex(3);
    EXPECT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
    EXPECT_TRUE(game.solver.addListener(&diary).ok());
    EXPECT_TRUE(game.water.addJet({bt(0.12), bt(0.2), 0}, {0, -1, 0}, 2, bt(0.08)).ok());
    EXPECT_TRUE(game.water.addJet({bt(0.12), bt(-0.15), 0}, {0, -1, 0}, 1, bt(0.04)).ok());
    game.run(150);
    return diary.order.str();
  };
  const std::string one = hear(1);
  EXPECT_TRUE(has(one, "\nb0") && has(one, "\nb1") && has(one, "\nb3")) << one.substr(0, 200);
  EXPECT_EQ(one, hear(4));
}

TEST(Listener, objects_and_listeners_may_be_deleted_within_a_call) {
  Game game;
  Plate plate(-0.05);
  auto second = std::make_unique<Diary>();
  Diary first, third, fourth;
  btSoftBody* cloth = game.bullet.patch(9, 0.4, 0, 15);
  cloth->setUserIndex(7);
  ASSERT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addCollisionObject(&plate.object, bt(0.002)).ok());
  for (Diary* diary : {&first, second.get(), &third, &fourth}) {
    ASSERT_TRUE(diary->setSplashThreshold(0).ok());
    ASSERT_TRUE(game.solver.addListener(diary).ok());
  }
  first.at_touch = [&](const btCollisionObject* object) {
    if (object != cloth) return;
    game.solver.removeCloth(cloth);
    game.bullet.destroy(cloth);
  };
  first.at_step = [&] {
    if (first.steps != 5) return;
    second.reset();
    game.solver.removeListener(&third);
  };
  ASSERT_TRUE(game.pour(0.01).ok());
  game.run(200);
  EXPECT_FALSE(second);
  EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
  EXPECT_GE(first.begun, 2) << "of the cloth, and of the plate below it";
  EXPECT_FALSE(has(first.order.str(), "\ns7")) << "nothing more of a deleted object";
  EXPECT_EQ(third.steps, 4) << "it was removed by the call before its own";
  EXPECT_EQ(fourth.steps, 200);
  EXPECT_EQ(fourth.begun, 1) << "of the plate";
  EXPECT_FALSE(has(fourth.order.str(), "\nb7") || has(fourth.order.str(), "\ns7"));
}

TEST(Listener, may_delete_the_fluid_and_itself) {
  Plate plate;
  btFluidCoupling coupling;
  auto water = std::make_unique<btFluid>(coarse_fluid(), small_world(), ContactSettings{});
  auto diary = std::make_unique<Diary>();
  ASSERT_TRUE(coupling.addFluid(water.get()).ok());
  ASSERT_TRUE(coupling.addListener(diary.get()).ok());
  ASSERT_TRUE(coupling.addCollisionObject(&plate.object, bt(0.002)).ok());
  diary->at_step = [&] {
    water.reset();
    diary.release();
  };
  Diary* const released = diary.get();
  EXPECT_EQ(coupling.step(bt(0.001)).dt, static_cast<double>(bt(0.001)));
  EXPECT_EQ(coupling.getFluid(), nullptr);
  delete released;
  EXPECT_FALSE(coupling.step(bt(0.001)).status.ok());
}

TEST(Listener, a_step_within_a_call_is_refused) {
  Game game;
  Diary diary;
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  diary.at_step = [&] { EXPECT_FALSE(game.solver.getCoupling().step(bt(0.001)).status.ok()); };
  game.run(3);
  EXPECT_EQ(diary.steps, 3);
  EXPECT_EQ(game.water.getWorld().step_count(), 3u);
  EXPECT_TRUE(game.solver.getReport().status.ok());
  EXPECT_TRUE(has(game.messages(), "a listener may not step"));
}

TEST(Listener, bad_input_is_refused) {
  Game game, other;
  Diary diary;
  EXPECT_FALSE(game.solver.addListener(nullptr).ok());
  ASSERT_TRUE(game.solver.addListener(&diary).ok());
  EXPECT_FALSE(game.solver.addListener(&diary).ok());
  EXPECT_FALSE(other.solver.addListener(&diary).ok());
  other.solver.removeListener(&diary);
  other.solver.removeListener(nullptr);
  game.run(1);
  EXPECT_EQ(diary.steps, 1);
  game.solver.removeListener(&diary);
  game.run(1);
  EXPECT_EQ(diary.steps, 1);
  const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
  for (const btScalar bad : {bt(-1), nan}) {
    EXPECT_FALSE(diary.setSplashThreshold(bad).ok());
    EXPECT_FALSE(game.solver.getCoupling().setTouchHold(bad).ok());
  }
  EXPECT_TRUE(std::isinf(diary.getSplashThreshold()));
  EXPECT_EQ(game.solver.getCoupling().getTouchHold(), bt(0.1));
  btVector3 linear(7, 7, 7), angular(7, 7, 7);
  Plate plate;
  EXPECT_FALSE(game.solver.getCoupling().takeImpulse(&plate.object, linear, angular));
  EXPECT_FALSE(game.solver.getCoupling().takeImpulse(nullptr, linear, angular));
  EXPECT_EQ(linear, btVector3(7, 7, 7));
}

TEST(Listener, a_coupling_may_be_deleted_before_its_listener) {
  Diary diary;
  auto coupling = std::make_unique<btFluidCoupling>();
  ASSERT_TRUE(coupling->addListener(&diary).ok());
  coupling.reset();
  btFluidCoupling again;
  EXPECT_TRUE(again.addListener(&diary).ok());
}

TEST(Coupling, contacts_name_their_object) {
  Game game;
  Plate upper(0), lower(-0.5);
  ASSERT_TRUE(game.solver.addCollisionObject(&lower.object, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addCollisionObject(&upper.object, bt(0.002)).ok());
  ASSERT_TRUE(game.pour(0.005).ok());
  game.run(60);
  btFluidCoupling& coupling = game.solver.getCoupling();
  ASSERT_FALSE(game.water.getWorld().contacts().empty());
  for (const Contact& c : game.water.getWorld().contacts())
    EXPECT_EQ(coupling.getObject(c.surface), &upper.object);
  EXPECT_EQ(coupling.getObject(coupling.getSurfaceId(&lower.object)), &lower.object);
  EXPECT_EQ(coupling.getObject(2u), nullptr);
  EXPECT_EQ(coupling.getObject(SurfaceId()), nullptr);
  game.solver.removeCollisionObject(&upper.object);
  EXPECT_EQ(coupling.getObject(1u), nullptr);
  EXPECT_EQ(coupling.getObject(0u), &lower.object);
  game.solver.removeFluid(&game.water);
  EXPECT_EQ(coupling.getObject(0u), nullptr);
}

TEST(Coupling, gravity_is_refused_or_wins) {
  Game game;
  const btVector3 up(0, bt(2), 0);
  ASSERT_TRUE(game.water.setGravity(up).ok());
  game.run(1);
  EXPECT_EQ(game.water.getGravity(), up);
  btSoftBody* cloth = game.bullet.patch(5, 0.4, 0, 15);
  ASSERT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
  const Status refused = game.water.setGravity(up);
  ASSERT_FALSE(refused.ok());
  EXPECT_TRUE(has(refused.message, "setUseClothGravity(false)")) << refused.message;
  game.run(1);
  EXPECT_EQ(game.water.getGravity(), game.bullet.world.getWorldInfo().m_gravity);
  game.solver.getCoupling().setUseClothGravity(false);
  ASSERT_TRUE(game.water.setGravity(up).ok());
  game.run(1);
  EXPECT_EQ(game.water.getGravity(), up);
  EXPECT_EQ(game.messages(), "");
  EXPECT_FALSE(game.water.setGravity({0, std::numeric_limits<btScalar>::infinity(), 0}).ok());
  EXPECT_EQ(game.water.getGravity(), up);
}

}  // namespace
}  // namespace oilskin::bullet
