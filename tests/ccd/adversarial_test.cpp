// The continuous test against exact arithmetic on queries made to be hard: the same answers, no false
// negative and no false positive, whatever the sizes of coordinates; the time of impact never late and hardly
// early.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "ccd/exact_arbiter.h"
#include "ccd/point_triangle.h"
#include "ccd/queries.h"

namespace oilskin::test {
namespace {

/// Queries per family; the environment may ask for more. Families for which the oracle takes long get a
/// tenth.
int queries_of(const Family& family) {
  const char* wanted = std::getenv("OILSKIN_CCD_QUERIES");
  const int count = wanted != nullptr ? std::atoi(wanted) : 2000;
  return family.wide ? count / 10 : count;
}

class Adversarial : public testing::TestWithParam<int> {};

TEST_P(Adversarial, AnswersAreExactAndNeverLate) {
  constexpr double kEarliest = 1e-6;
  const Family& family = families()[GetParam()];
  Random random(1000 + GetParam());
  const int count = queries_of(family);
  int hits = 0, at_rest = 0, false_negatives = 0, false_positives = 0;
  double earliest = 0;
  for (int i = 0; i < count; ++i) {
    const Corners x = family.make(random);
    const ccd::Meeting found = ccd::point_triangle(to_motion(x));
    if (x[0] == x[4] && x[1] == x[5] && x[2] == x[6] && x[3] == x[7]) {
      ++at_rest;
      ASSERT_FALSE(found.hit) << "what does not move is no hit by contract";
      continue;
    }
    const exact::Answer truth = exact::point_triangle(to_exact(x));
    // Plain arithmetic answers most queries: exact arithmetic, its last resort, is asked all of them here.
    const ccd::Meeting exact_meeting = ccd::detail::exact_meeting(to_motion(x));
    ASSERT_EQ(exact_meeting.hit, truth.hit) << "wrong, query " << i;
    if (truth.hit) {
      ASSERT_LE(exact_meeting.time, truth.touch_lower) << "late, query " << i;
      ASSERT_NEAR(exact_meeting.time, truth.touch_lower, 2e-12) << "early, query " << i;
    }
    hits += truth.hit ? 1 : 0;
    false_negatives += truth.hit && !found.hit ? 1 : 0;
    false_positives += found.hit && !truth.hit ? 1 : 0;
    if (!truth.hit || !found.hit) continue;
    ASSERT_LE(found.time, truth.touch_lower) << "late, query " << i;
    earliest = std::max(earliest, truth.touch_lower - found.time);
  }
  std::cout << "  " << family.name << ": queries " << count << ", hits " << hits << ", false negatives "
            << false_negatives << ", false positives " << false_positives << ", earliest " << earliest
            << '\n';
  EXPECT_EQ(false_negatives, 0);
  EXPECT_EQ(false_positives, 0);
  EXPECT_LE(earliest, kEarliest);
  EXPECT_GT(hits, count / 25);  // or the family is dull
  EXPECT_GT(count - hits - at_rest, count / 25);
}

INSTANTIATE_TEST_SUITE_P(Families, Adversarial, testing::Range(0, static_cast<int>(families().size())));

}  // namespace
}  // namespace oilskin::test
