// What a validation says of its runs.
#include "study/run/case_judgement.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oilskin::demo {
namespace {

ValidationCase made_up() {
  ValidationCase c;
  c.name = "made_up";
  c.spacings = {0.04, 0.02, 0.01};
  return c;
}

CaseRun run_with(double spacing, const Quantity& quantity) {
  CaseRun run;
  run.spacing = spacing;
  run.quantities = {quantity};
  return run;
}

/// Errors factor × spacing^order about 2.
CaseLevels series(const ValidationCase& of, double factor, double order, double uncertainty = 0) {
  CaseLevels levels{of, {}};
  for (const double spacing : of.spacings) {
    const double sign = levels.runs.size() % 2 == 0 ? 1 : -1;  // the error counts, not its sign
    Quantity q{"length", 2 * (1 + sign * factor * std::pow(spacing, order)), 2};
    q.uncertainty = uncertainty;
    levels.runs.push_back(run_with(spacing, q));
  }
  return levels;
}

TEST(Judgement, finds_the_order_of_a_series) {
  const ValidationCase of = made_up();
  for (const double order : {0.5, 1.0, 2.0, -1.0})
    EXPECT_NEAR(observed_order(series(of, 0.3, order), "length").value(), order, 1e-9);
}

TEST(Judgement, there_is_no_order_where_the_reference_is_not_known_better) {
  const ValidationCase of = made_up();
  EXPECT_FALSE(observed_order(series(of, 0.3, 1, 0.004), "length")) << "the finest error is 0.003";
  EXPECT_TRUE(observed_order(series(of, 0.3, 1, 0.002), "length"));
  EXPECT_FALSE(observed_order(series(of, 0, 1), "length")) << "no error at all";
  EXPECT_FALSE(observed_order(series(of, 0.3, 1), "width")) << "not measured";
  CaseLevels one = series(of, 0.3, 1);
  one.runs.resize(1);
  EXPECT_FALSE(observed_order(one, "length"));
}

TEST(Judgement, tolerances_grow_with_the_spacing_from_the_finest) {
  const ValidationCase of = made_up();
  Quantity q{"length", 1, 1, 0, 0, 0.01, 1};
  EXPECT_DOUBLE_EQ(tolerance_at(of, run_with(0.01, q), q), 0.01);
  EXPECT_DOUBLE_EQ(tolerance_at(of, run_with(0.04, q), q), 0.04);
  EXPECT_DOUBLE_EQ(tolerance_at(of, run_with(0.005, q), q), 0.01) << "no stricter on finer grids";
  q.order = 0;
  EXPECT_DOUBLE_EQ(tolerance_at(of, run_with(0.04, q), q), 0.01);
}

TEST(Judgement, a_value_beyond_its_tolerance_is_missed) {
  const ValidationCase of = made_up();
  const auto judged = [&](double value, double tolerance) {
    const Quantity q{"length", value, 1, 0, 0, tolerance};
    const CaseRun run = run_with(0.01, q);
    EXPECT_EQ(passes(of, run), std::string(verdict(of, run, q)) != "MISSED");
    return std::string(verdict(of, run, q));
  };
  EXPECT_EQ(judged(1.009, 0.01), "ok");
  EXPECT_EQ(judged(1.011, 0.01), "MISSED");
  EXPECT_EQ(judged(0.989, 0.01), "MISSED");
  EXPECT_EQ(judged(std::nan(""), 0.01), "MISSED");
  EXPECT_EQ(judged(7, never), "");
}

TEST(Judgement, a_run_that_broke_off_or_leaked_does_not_pass) {
  const ValidationCase of = made_up();
  const CaseRun good = run_with(0.01, {"length", 1, 1, 0, 0, 0.01});
  EXPECT_TRUE(passes(of, good));
  CaseRun leaked = good, failed = good, empty = good;
  leaked.crossings = 1;
  failed.failure = "refused";
  empty.quantities.clear();
  for (const CaseRun& run : {leaked, failed, empty}) EXPECT_FALSE(passes(of, run));
}

}  // namespace
}  // namespace oilskin::demo
