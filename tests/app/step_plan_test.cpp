// Lengths of steps, fixed and adaptive: frames and the end are met.
#include "hosts/step_plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oilskin::demo {
namespace {

Scene scene(bool adaptive, double duration, double frames_per_second) {
  Scene s;
  s.dt = 0.004;
  s.min_dt = 1e-4;
  s.adaptive_dt = adaptive;
  s.duration = duration;
  s.pictures.frames_per_second = frames_per_second;
  return s;
}

TEST(SimulatedTime, equal_steps_are_multiplied_not_added_up) {
  SimulatedTime time;
  for (int k = 1; k <= 1000; ++k) {
    time.add(0.001);
    ASSERT_EQ(time.value(), 0.001 * k);
  }
  time.add(0.5);
  EXPECT_EQ(time.value(), 0.001 * 1000 + 0.5);
  ASSERT_EQ(time.runs().size(), 2u);
  EXPECT_EQ(time.runs()[0].count, 1000u);
  EXPECT_EQ(time.steps(), 1001u);
}

TEST(StepPlan, fixed_steps_reach_the_duration_whatever_is_suggested) {
  StepPlan plan(scene(false, 0.0405, 30));
  SimulatedTime time;
  while (!plan.done(time)) time.add(plan.next(time.value(), 1e-6));
  EXPECT_EQ(time.steps(), 11u);
  EXPECT_EQ(plan.fraction(time), 1);
}

TEST(StepPlan, adaptive_steps_end_at_every_frame_and_at_the_end) {
  for (double frames_per_second : {0.0, 30.0, 1000.0 / 7}) {
    const Scene s = scene(true, 0.21, frames_per_second);
    StepPlan plan(s);
    SimulatedTime time;
    double next_frame = frames_per_second > 0 ? 1 / frames_per_second : 1e9;
    int k = 0;
    while (!plan.done(time)) {
      const double suggested = 0.002 * (1.2 + std::sin(0.1 * ++k));
      const double dt = plan.next(time.value(), suggested);
      ASSERT_GE(dt, plan.shortest());
      ASSERT_LE(dt, s.dt);
      time.add(dt);
      ASSERT_LE(time.value(), next_frame + 1e-12) << "a frame was jumped over";
      if (plan.reached(time.value(), next_frame)) {
        EXPECT_NEAR(time.value(), next_frame, 1e-12);
        next_frame += 1 / frames_per_second;
      }
    }
    EXPECT_NEAR(time.value(), 0.21, 1e-12);
    EXPECT_EQ(plan.fraction(time), 1);
  }
}

TEST(StepPlan, adaptive_steps_keep_their_limits_and_change_gradually) {
  StepPlan plan(scene(true, 1, 0));
  double t = 0, last = plan.next(t, 1);
  EXPECT_EQ(last, 0.004);
  for (int k = 0; k < 40; ++k) {
    const double dt = plan.next(t += last, k < 20 ? 1e-9 : 1);
    EXPECT_GE(dt, 0.5 * last);
    EXPECT_LE(dt, 1.1 * last * (1 + 1e-12));
    last = dt;
    if (k == 19) {
      EXPECT_EQ(dt, 1e-4);
    }
  }
  EXPECT_GT(last, 5e-4);
}

}  // namespace
}  // namespace oilskin::demo
