// The stop rule, the relaxation and the divergence rule of the pressure solvers.
#include "fluid/pressure/pressure_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace oilskin::fluid {
namespace {

/// Errors whose mean above the target is `mean`.
Errors errors_of(double mean) {
  Errors e;
  e.add(mean, 0, 1);
  return e;
}

/// Iterations of a loop whose error after n iterations is error(n).
template <class F>
int iterations_until(PressureLoop& loop, const LoopGoal& goal, const F& error) {
  loop.start(goal);
  int n = 0;
  while (!loop.judge(errors_of(error(++n))).stop) continue;
  EXPECT_EQ(loop.iterations(), n);
  return n;
}

TEST(PressureLoop, a_limit_ends_it_but_not_before_the_least_number) {
  PressureLoop loop(0.5, 20);
  LoopGoal goal;
  goal.tolerance = 1e-3;
  goal.min_iterations = 3;
  const auto slow = [](int) { return 0.01; };
  EXPECT_EQ(iterations_until(loop, goal, slow), 20);
  loop.limit_iterations(7);
  EXPECT_EQ(iterations_until(loop, goal, slow), 7);
  EXPECT_FALSE(loop.converged());
  loop.limit_iterations(1);
  EXPECT_EQ(iterations_until(loop, goal, slow), 3);
  loop.limit_iterations(1000);
  EXPECT_EQ(iterations_until(loop, goal, slow), 20);
}

TEST(Errors, count_compression_only) {
  Errors e;
  e.add(0.02, 0.005, 0.001);
  e.add(-0.0005, 0.005, 0.001);  // counts with error 0
  e.add(-0.3, 0.005, 0.001);     // free surface
  EXPECT_EQ(e.counted, 2u);
  EXPECT_EQ(e.mean(e.sum), 0.01);
  EXPECT_EQ(e.mean(e.above_target), 0.0075);
  EXPECT_EQ(e.largest, 0.02);
  e.add(std::nan(""), 0, 0.001);
  EXPECT_TRUE(std::isnan(e.mean(e.above_target)));
}

TEST(PressureLoop, ends_at_the_tolerance_or_at_the_limit) {
  PressureLoop loop(1, 50);
  const auto halved = [](int n) { return std::pow(0.5, n); };
  EXPECT_EQ(iterations_until(loop, {1e-2, 1, {}}, halved), 7);
  EXPECT_TRUE(loop.converged());
  EXPECT_EQ(iterations_until(loop, {1e-2, 10, {}}, halved), 10);
  EXPECT_EQ(iterations_until(loop, {1e-2, 1, {}}, [](int) { return 0.02; }), 50);
  EXPECT_FALSE(loop.converged());
  EXPECT_FALSE(loop.diverged());
}

TEST(PressureLoop, a_growing_error_halves_the_relaxation) {
  PressureLoop loop(0.8, 100);
  loop.start({1e-3, 1, {}});
  int restarts = 0;
  for (int n = 1; n <= 8; ++n) restarts += loop.judge(errors_of(0.1 * n)).restart;
  EXPECT_EQ(restarts, 2) << "after three larger errors in a row each";
  EXPECT_TRUE(loop.diverged());
  EXPECT_EQ(loop.relaxation(), 0.2);
  loop.begin_step();
  EXPECT_GT(loop.relaxation(), 0.2);
  for (int step = 0; step < 200; ++step) loop.begin_step();
  EXPECT_EQ(loop.relaxation(), 0.8);

  // Near the tolerance a growing error is no divergence.
  loop.start({1e-3, 1, {}});
  for (int n = 1; n <= 8; ++n) EXPECT_FALSE(loop.judge(errors_of(2e-3 + 1e-4 * n)).restart);

  // Nor is one that creeps.
  loop.start({1e-3, 1, {}});
  for (int n = 1; n <= 50; ++n) EXPECT_FALSE(loop.judge(errors_of(0.1 + 1e-4 * n)).restart);
}

TEST(PressureLoop, an_error_that_is_not_finite_resets_the_pressures) {
  PressureLoop loop(1, 3);
  loop.start({1e-3, 1, {}});
  const PressureLoop::Verdict lost = loop.judge(errors_of(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(lost.finite);
  EXPECT_TRUE(lost.restart);
  EXPECT_FALSE(lost.stop);
  EXPECT_EQ(loop.relaxation(), 0.5);
  EXPECT_TRUE(loop.judge(errors_of(1)).finite);
}

TEST(PressureLoop, the_number_of_iterations_falls_slowly) {
  // The error is proportional to the inverse square of the iterations, so that 10 would do.
  const auto error = [](int n) { return 1e-3 * 100 / (n * n); };
  PressureLoop loop(1, 100);
  IterationController controller{40, 0};
  int steps = 0;
  for (int last = 40; last > 13; ++steps) {
    const int n = iterations_until(loop, {1e-3, 2, controller}, error);
    EXPECT_LE(n, last);
    EXPECT_GE(1.18 * n + 1, last) << "by a sixth at most";
    controller = loop.next_controller();
    last = n;
    ASSERT_LT(steps, 100);
  }
  EXPECT_GT(steps, 20) << "every fourth step at most";
  // It rises at once.
  EXPECT_EQ(iterations_until(loop, {1e-3, 2, controller}, [&](int n) { return 8.9 * error(n); }), 30);
}

}  // namespace
}  // namespace oilskin::fluid
