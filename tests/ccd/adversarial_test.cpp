// The continuous test against exact arithmetic on queries made to be hard. Asymmetric on purpose: a false
// negative or a late time of impact fails, a false positive is counted.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "ccd/point_triangle.h"
#include "ccd/queries.h"

namespace oilskin::test {
namespace {

/// Queries per family; the environment may ask for more.
int queries_per_family() {
  const char* wanted = std::getenv("OILSKIN_CCD_QUERIES");
  return wanted != nullptr ? std::atoi(wanted) : 2000;
}

class Adversarial : public testing::TestWithParam<int> {};

TEST_P(Adversarial, NoFalseNegativeAndNeverLate) {
  const Family& family = families()[GetParam()];
  Random random(1000 + GetParam());
  int hits = 0, false_positives = 0;
  double earliest = 0;
  for (int i = 0; i < queries_per_family(); ++i) {
    const Corners x = family.make(random);
    const ccd::Meeting found = ccd::point_triangle(to_motion(x));
    const exact::Answer truth = exact::point_triangle(to_exact(x));
    hits += truth.hit ? 1 : 0;
    false_positives += found.hit && !truth.hit ? 1 : 0;
    const bool at_rest = x[0] == x[4] && x[1] == x[5] && x[2] == x[6] && x[3] == x[7];
    if (!truth.hit || at_rest) continue;  // what does not move is no hit by contract
    ASSERT_TRUE(found.hit) << "false negative, query " << i;
    ASSERT_LE(found.time, truth.touch_lower) << "late, query " << i;
    earliest = std::max(earliest, truth.touch_lower - found.time);
  }
  RecordProperty("false_positives", false_positives);
  std::cout << "  " << family.name << ": queries " << queries_per_family() << ", hits " << hits
            << ", false negatives 0, false positives " << false_positives << ", earliest " << earliest
            << '\n';
}

INSTANTIATE_TEST_SUITE_P(Families, Adversarial, testing::Range(0, static_cast<int>(families().size())));

}  // namespace
}  // namespace oilskin::test
