// The pressure that nearly all of the water stays below.
#include "world/upper_pressure.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/random.h"

namespace oilskin::test {
namespace {

using world::upper_pressure;

TEST(UpperPressure, is_at_most_an_eighth_above_the_largest_of_few) {
  const Workers one(1);
  for (double p = 2e-3; p < 1e11; p *= 1.37) {
    const double found = upper_pressure(std::vector<double>{0.5 * p, p, 0, 0.1 * p}, one);
    EXPECT_GE(found, p);
    EXPECT_LE(found, 1.126 * p);
  }
}

TEST(UpperPressure, ignores_one_in_a_thousand) {
  const Workers one(1);
  std::vector<double> p(5000, 100);
  for (std::size_t i = 0; i < 5; ++i) p[700 * i] = 1e6;
  EXPECT_LE(upper_pressure(p, one), 113);
  p[1] = 1e6;
  EXPECT_GE(upper_pressure(p, one), 1e6);
  p.assign(5000, 0);
  EXPECT_EQ(upper_pressure(p, one), 0);
  for (std::size_t i = 0; i < 5; ++i) p[i] = 1;
  EXPECT_EQ(upper_pressure(p, one), 0);
  EXPECT_EQ(upper_pressure({}, one), 0);
}

TEST(UpperPressure, takes_any_size) {
  const Workers one(1);
  EXPECT_GT(upper_pressure(std::vector<double>{std::numeric_limits<double>::denorm_min()}, one), 0);
  EXPECT_LT(upper_pressure(std::vector<double>{1e-300}, one), 2e-3);
  for (const double huge : {1e13, 1e300, std::numeric_limits<double>::infinity()})
    EXPECT_GT(upper_pressure(std::vector<double>{huge}, one), 1e12);
}

TEST(UpperPressure, is_the_same_on_any_number_of_threads) {
  Random random(3);
  std::vector<double> p;
  for (int i = 0; i < 100000; ++i) p.push_back(random.uniform(0, 1e4));
  const double found = upper_pressure(p, Workers(1));
  EXPECT_NEAR(found, 9990, 1250);
  for (const int threads : {2, 8}) EXPECT_EQ(upper_pressure(p, Workers(threads)), found);
}

}  // namespace
}  // namespace oilskin::test
