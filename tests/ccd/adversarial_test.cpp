// The continuous test against exact arithmetic on hard queries: the same results, no false negative and no
// false positive for coordinates of any size; the time of impact is never late and hardly early.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "ccd/exact_query.h"
#include "ccd/point_triangle.h"
#include "ccd/queries.h"
#include "support/record.h"

namespace oilskin::test {
namespace {

/// Queries per family; the environment may ask for more. Families for which the oracle takes long get a
/// tenth.
int queries_of(const Family& family) {
  const char* wanted = std::getenv("OILSKIN_CCD_QUERIES");
  const int count = wanted != nullptr ? std::atoi(wanted) : 2000;
  return family.wide ? count / 10 : count;
}

/// exact_impact_from() with parts of the step before which nothing touches.
void expect_known_start_helps(const ccd::PointTriangleMotion& m, const exact::Answer& truth, int query) {
  const double touch = truth.hit ? truth.touch_lower : 0.3;
  for (const double width : {1e-8, 1e-12}) {
    const ccd::detail::TimeSpan around{std::max(0.0, touch - width), std::min(1.0, touch + width)},
        before{std::max(0.0, touch - 3 * width), std::max(0.5 * width, touch - 2 * width)};
    const ccd::Impact in = ccd::detail::exact_impact_from(m, around);
    ASSERT_EQ(in.hit, truth.hit) << "query " << query;
    if (truth.hit) {
      ASSERT_LE(in.time, truth.touch_lower) << "query " << query;
      ASSERT_GE(in.time, around.begin - 4e-12) << "query " << query;
    }
    const ccd::Impact after = ccd::detail::exact_impact_from(m, before);
    ASSERT_EQ(after.hit, truth.hit) << "query " << query;
    if (truth.hit) {
      ASSERT_LE(after.time, truth.touch_lower) << "query " << query;
      ASSERT_NEAR(after.time, truth.touch_lower, 4 * width) << "query " << query;
    }
  }
}

/// At an end of the step: inside if the four points at rest touch, otherwise the sign of the determinant.
void expect_right_placement(const Corners& x, int end, int query) {
  Corners at_rest;
  for (int i = 0; i < 8; ++i) at_rest[i] = x[4 * end + i % 4];
  const auto relative = [&](int i, int axis) {
    return exact::Integer::from_double(at_rest[i][axis], 1074) -
           exact::Integer::from_double(at_rest[1][axis], 1074);
  };
  const auto minor = [&](int y, int z) {
    return relative(2, y) * relative(3, z) - relative(2, z) * relative(3, y);
  };
  const int side =
      (relative(0, 0) * minor(1, 2) + relative(0, 1) * minor(2, 0) + relative(0, 2) * minor(0, 1)).sign();
  using ccd::detail::ExactLocation;
  switch (ccd::detail::exact_location(to_motion(x), end)) {
    case ExactLocation::positive_side:
      ASSERT_EQ(side, 1) << "query " << query;
      break;
    case ExactLocation::negative_side:
      ASSERT_EQ(side, -1) << "query " << query;
      break;
    case ExactLocation::inside:
      ASSERT_TRUE(exact::point_triangle(to_exact(at_rest)).hit) << "query " << query;
      break;
    case ExactLocation::outside:
      ASSERT_EQ(side, 0) << "query " << query;
      ASSERT_FALSE(exact::point_triangle(to_exact(at_rest)).hit) << "query " << query;
      break;
    case ExactLocation::unknown:
      break;
  }
}

class Adversarial : public testing::TestWithParam<int> {};

TEST_P(Adversarial, results_are_exact_and_never_late) {
  constexpr double kEarliest = 1e-6;
  const Family& family = families()[GetParam()];
  Random random(1000 + GetParam());
  const int count = queries_of(family);
  int hits = 0, false_negatives = 0, false_positives = 0;
  double earliest = 0;
  for (int i = 0; i < count; ++i) {
    const Corners x = family.make(random);
    const ccd::Impact found = ccd::point_triangle(to_motion(x));
    const exact::Answer truth = exact::point_triangle(to_exact(x));
    // The filter decides most queries. Here exact arithmetic decides all of them, too.
    const ccd::Impact exact_impact = ccd::detail::exact_impact(to_motion(x));
    ASSERT_EQ(exact_impact.hit, truth.hit) << "wrong, query " << i;
    if (truth.hit) {
      ASSERT_LE(exact_impact.time, truth.touch_lower) << "late, query " << i;
      ASSERT_NEAR(exact_impact.time, truth.touch_lower, 2e-12) << "early, query " << i;
    }
    expect_known_start_helps(to_motion(x), truth, i);
    for (int end = 0; end < 2; ++end) expect_right_placement(x, end, i);
    hits += truth.hit ? 1 : 0;
    false_negatives += truth.hit && !found.hit ? 1 : 0;
    false_positives += found.hit && !truth.hit ? 1 : 0;
    if (!truth.hit || !found.hit) continue;
    ASSERT_LE(found.time, truth.touch_lower) << "late, query " << i;
    earliest = std::max(earliest, truth.touch_lower - found.time);
  }
  test::record("queries", count);
  test::record("hits", hits);
  test::record("earliest", earliest);
  EXPECT_EQ(false_negatives, 0);
  EXPECT_EQ(false_positives, 0);
  EXPECT_LE(earliest, kEarliest);
  EXPECT_GT(hits, count / 25);  // or the family is dull
  EXPECT_GT(count - hits, count / 25);
}

INSTANTIATE_TEST_SUITE_P(Families, Adversarial, testing::Range(0, static_cast<int>(families().size())));

}  // namespace
}  // namespace oilskin::test
