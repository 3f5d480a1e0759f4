// The stop rule, the relaxation and the divergence rule of the pressure solvers.
#include "fluid/pressure/pressure_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
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

/// Steps of 1 ms whose error is proportional to the inverse square of the number, as in water at rest.
class Steps {
 public:
  /// The number of iterations of a step in which `needed` leave 0.9 of the tolerance.
  int step(double needed) {
    constexpr double tolerance = 1e-3;
    const int n = iterations_until(loop_, {tolerance, 2, controller_},
                                   [&](int k) { return 0.9 * tolerance * needed * needed / (k * k); });
    controller_ = loop_.next_controller(1e-3);
    return n;
  }

 private:
  PressureLoop loop_{1, 100};
  IterationController controller_;
};

TEST(PressureLoop, the_number_of_iterations_forgets_what_one_impact_needed) {
  Steps steps;
  EXPECT_EQ(steps.step(45), 43) << "it rises at once";
  int last = 43, calm = 0;
  for (; last > 10 && calm < 100; ++calm) {
    const int n = steps.step(10);
    EXPECT_LE(n, last);
    EXPECT_GE(n, std::floor(last - std::max(1.0, 0.15 * last))) << "by a seventh at most";
    last = n;
  }
  EXPECT_LT(calm, 20);
  for (int k = 0; k < 200; ++k) EXPECT_EQ(steps.step(10), 10);
  EXPECT_EQ(steps.step(25), 24);
}

TEST(PressureLoop, the_number_of_iterations_stays_at_what_a_swing_needs) {
  for (const int period : {30, 55, 80}) {
    Steps steps;
    for (int k = 0; k < 2 * period; ++k) steps.step(k % period < 3 ? 21 : 10);
    for (int k = 0; k < 20 * period; ++k)
      ASSERT_EQ(steps.step(k % period < 3 ? 21 : 10), 20) << "period " << period << " ms, after " << k;
    int calm = 0;
    for (; steps.step(10) > 10; ++calm) ASSERT_LT(calm, 220) << "period " << period << " ms";
    EXPECT_GT(calm, 30) << "period " << period << " ms";
  }
}

TEST(PressureLoop, a_step_that_does_not_converge_needed_all_its_iterations) {
  PressureLoop loop(1, 12);
  IterationController controller;
  for (int k = 0; k < 2; ++k) {  // 60 ms apart
    EXPECT_EQ(iterations_until(loop, {1e-3, 2, controller}, [](int) { return 1; }), 12);
    controller = loop.next_controller(0.06);
  }
  EXPECT_EQ(controller.floor(), 12);
  EXPECT_EQ(iterations_until(loop, {1e-3, 2, controller}, [](int) { return 1e-6; }), 12);
}

}  // namespace
}  // namespace oilskin::fluid
