// Cloth and bodies that are pulled, on the mock host and on Bullet.
#include <gtest/gtest.h>

#include "view/small_scene.h"

namespace oilskin::demo {
namespace {

using test::small_scene;
using test::take_steps;

class OnHost : public testing::TestWithParam<const char*> {
 protected:
  Scene scene(const std::vector<std::string>& more = {}) const { return small_scene(GetParam(), more); }
};

const Vec3& node(LiveScene& live, std::size_t k) {
  return live.simulation().cloth(0)->x_t1[k];
}

constexpr std::size_t middle = 6 * 13 + 6, corner = 0;

TEST_P(OnHost, the_held_node_goes_where_it_is_pulled_and_nothing_crosses) {
  LiveScene live = test::live_scene(scene());
  take_steps(live, 5);
  const Vec3 start = node(live, middle);
  ASSERT_TRUE(live.simulation().grab_cloth(0, start + Vec3(0.001, 0, 0.001)).ok());
  ASSERT_EQ(live.simulation().grip()->nodes.front(), middle);
  const Vec3 goal = start + Vec3(0.02, 0.06, -0.01);
  live.simulation().pull_to(goal);
  live.step();
  EXPECT_GT((node(live, middle) - start).dot(goal - start), 0);
  EXPECT_LT((node(live, middle) - start).norm(), 3 * 0.002 + 1e-9) << "no faster than 3 m/s";
  take_steps(live, 150);
  EXPECT_LT((node(live, middle) - goal).norm(), 0.001);
  EXPECT_EQ(live.simulation().cloth(0)->inverse_mass[middle], 0);
  EXPECT_EQ(live.counts().crossings, 0u);
  live.simulation().let_go();
  take_steps(live, 20);
  EXPECT_GT(live.simulation().cloth(0)->inverse_mass[middle], 0);
  EXPECT_LT(node(live, middle).y(), goal.y() - 0.005) << "it falls";
  EXPECT_EQ(live.counts().crossings, 0u);
}

TEST_P(OnHost, a_pin_that_was_pulled_stays_pinned_where_it_is_left) {
  LiveScene live = test::live_scene(scene());
  take_steps(live, 2);
  const Vec3 goal = node(live, corner) + Vec3(0.03, 0.02, 0.03);
  ASSERT_TRUE(live.simulation().grab_cloth(0, node(live, corner)).ok());
  live.simulation().pull_to(goal);
  take_steps(live, 100);
  live.simulation().let_go();
  const Vec3 left = node(live, corner);
  EXPECT_LT((left - goal).norm(), 0.001);
  take_steps(live, 30);
  EXPECT_EQ(node(live, corner), left);
}

TEST_P(OnHost, pins_that_the_scene_moves_are_not_held) {
  LiveScene live =
      test::live_scene(scene({R"(cloth.0.pins=[{"within": {"min": [-1, -1, -1], "max": [-0.11, 1, 1]},
    "motion": {"velocity": [0, 0.1, 0]}}])"}));
  take_steps(live, 2);
  const Status status = live.simulation().grab_cloth(0, node(live, corner));
  EXPECT_FALSE(status.ok());
  EXPECT_FALSE(live.simulation().grip());
}

TEST_P(OnHost, a_body_keeps_the_place_to_which_it_was_pulled) {
  LiveScene live = test::live_scene(scene());
  take_steps(live, 2);
  const Vec3 before = live.simulation().body(0)->x_t1[0];
  live.simulation().grab_body(0, Vec3(0, -0.28, 0));
  live.simulation().pull_to(Vec3(0.05, -0.2, 0));
  take_steps(live, 150);
  live.simulation().let_go();
  const Vec3 moved = live.simulation().body(0)->x_t1[0] - before;
  EXPECT_LT((moved - Vec3(0.05, 0.08, 0)).norm(), 0.001);
  take_steps(live, 5);
  EXPECT_EQ(live.simulation().body(0)->x_t1[0] - before, moved);
  EXPECT_EQ(live.counts().crossings, 0u);
}

TEST_P(OnHost, nobody_is_held_after_a_restart_and_goals_without_a_grip_are_ignored) {
  LiveScene live = test::live_scene(scene());
  take_steps(live, 2);
  ASSERT_TRUE(live.simulation().grab_cloth(0, node(live, middle)).ok());
  live.restart();
  EXPECT_FALSE(live.simulation().grip());
  LiveScene plain = test::live_scene(scene());
  live.simulation().pull_to(Vec3(1, 1, 1));
  live.simulation().let_go();
  take_steps(live, 4);
  take_steps(plain, 4);
  EXPECT_EQ(live.world().state_hash(), plain.world().state_hash());
}

/// The water and gravity move it before and afterwards.
TEST(GripOnBullet, a_floating_body_is_held_and_let_go) {
  LiveScene live = test::live_scene(small_scene(
      "bullet", {R"(bodies.1={"shape": "box", "center": [0.3, 0.1, 0], "half_extents": [0.03, 0.03, 0.03],
                              "density": 500})"}));
  const auto height = [&] { return live.simulation().body(1)->x_t1[0].y(); };
  take_steps(live, 10);
  const double start = height();
  take_steps(live, 10);
  EXPECT_LT(height(), start - 1e-4) << "it falls";
  const double held = height();
  live.simulation().grab_body(1, Vec3(0.3, 0.1, 0));
  take_steps(live, 20);
  EXPECT_NEAR(height(), held, 1e-6);
  live.simulation().pull_to(Vec3(0.3, 0.2, 0));
  take_steps(live, 150);
  EXPECT_NEAR(height(), held + 0.1, 0.001);
  live.simulation().let_go();
  take_steps(live, 40);
  EXPECT_LT(height(), held + 0.099) << "it falls again";
  EXPECT_EQ(live.counts().crossings, 0u);
}

INSTANTIATE_TEST_SUITE_P(Grip, OnHost, testing::Values("mock", "bullet"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace oilskin::demo
