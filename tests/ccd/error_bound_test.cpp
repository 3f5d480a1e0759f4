// The error bounds of the cubic and of separating directions against true values in quadruple precision.
#include <gtest/gtest.h>

#include <cmath>

#include "ccd/coplanarity_cubic.h"
#include "ccd/queries.h"
#include "ccd/separation.h"
#include "support/record.h"

#ifdef __SIZEOF_FLOAT128__

namespace oilskin::test {
namespace {

__extension__ using Quad = __float128;
using QuadVector = std::array<Quad, 3>;

QuadVector difference_at(const Corners& x, int i, int j, double t) {
  QuadVector d;
  for (int k = 0; k < 3; ++k) {
    const Quad start = static_cast<Quad>(x[i][k]) - x[j][k],
               end = static_cast<Quad>(x[4 + i][k]) - x[4 + j][k];
    d[k] = t == 0 ? start : (t == 1 ? end : start + t * (end - start));
  }
  return d;
}

Quad determinant(const QuadVector& e, const QuadVector& f, const QuadVector& w) {
  return (e[1] * f[2] - e[2] * f[1]) * w[0] + (e[2] * f[0] - e[0] * f[2]) * w[1] +
         (e[0] * f[1] - e[1] * f[0]) * w[2];
}

using QuadCoefficients = std::array<Quad, 4>;

QuadCoefficients true_coefficients(const Corners& x) {
  std::array<QuadVector, 2> e, f, w;
  for (int end = 0; end < 2; ++end) {
    e[end] = difference_at(x, 2, 1, end);
    f[end] = difference_at(x, 3, 1, end);
    w[end] = difference_at(x, 0, 1, end);
  }
  QuadCoefficients k{};
  for (int i = 0; i < 8; ++i) {  // every choice of ends, by the number of late ones
    const int late = (i & 1) + (i >> 1 & 1) + (i >> 2 & 1);
    k[late] += determinant(e[i & 1], f[i >> 1 & 1], w[i >> 2 & 1]) / (late == 1 || late == 2 ? 3 : 1);
  }
  return k;
}

/// The blossom: affine in each time; its values at ends of a part are the coefficients there.
Quad blossom(QuadCoefficients k, const std::array<double, 3>& times) {
  for (int level = 0; level < 3; ++level) {
    const Quad t = times[level];
    for (int i = 0; i + level < 3; ++i) k[i] = (1 - t) * k[i] + t * k[i + 1];
  }
  return k[0];
}

ccd::detail::RelativeMotion relative(const Corners& x) {
  ccd::detail::RelativeMotion r;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      r.t0[i][k] = x[1 + i][k] - x[0][k];
      r.t1[i][k] = x[5 + i][k] - x[4][k];
    }
  }
  return r;
}

/// The largest error of a coefficient on the step, of one on a part, or of a value, relative to the bound.
double ratio_to_bound(const Corners& x, double begin, double end) {
  const ccd::detail::CoplanarityCubic cubic(to_motion(x), relative(x));
  if (!cubic.bounded()) return 0;
  const QuadCoefficients k = true_coefficients(x);
  const ccd::detail::Coefficients part = cubic.on({begin, end});
  double max_ratio = 0;
  const auto compare = [&](Quad truth, double computed) {
    const auto error = static_cast<double>(truth - static_cast<Quad>(computed));
    max_ratio = std::max(max_ratio, std::abs(error) / cubic.error());
  };
  for (int i = 0; i < 4; ++i) compare(k[i], cubic.coefficients().k[i]);
  for (int i = 0; i < 4; ++i) {
    compare(blossom(k, {i > 2 ? end : begin, i > 1 ? end : begin, i > 0 ? end : begin}), part.k[i]);
  }
  compare(blossom(k, {begin, begin, begin}), cubic.value(begin));
  return max_ratio;
}

bool within_range_of_quads(const Family& family) {
  return !family.wide && family.name != "denormal" && family.name != "tiny" && family.name != "huge";
}

TEST(CoplanarityCubic, errors_stay_within_the_bound) {
  Random random(23);
  for (const Family& family : families()) {
    if (!within_range_of_quads(family)) continue;
    double max_ratio = 0;
    for (int i = 0; i < 3000; ++i) {
      const Corners x = family.make(random);
      max_ratio = std::max(max_ratio, ratio_to_bound(x, random.uniform(0, 1), random.uniform(0, 1)));
    }
    test::record(std::string(family.name) + ", error over its bound", max_ratio);
    EXPECT_LE(max_ratio, 1);
  }
}

/// Searches for the largest ratio by changing one number at a time.
template <class Ratio>
double climb(std::vector<double> x, Random& random, int steps, Ratio ratio) {
  double best = ratio(x);
  for (int i = 0; i < steps; ++i) {
    double& one = x[random.integer(0, static_cast<int>(x.size()) - 1)];
    const double before = one;
    one = random.integer(0, 1) == 0 ? random.uniform(-1, 1) : one * (1 + random.power_of_ten(-16, -1));
    const double found = ratio(x);
    if (found < best) {
      one = before;
    } else {
      best = found;
    }
  }
  return best;
}

/// Errors of random input cancel. A search for errors that add up shows how tight the bound is: with a
/// constant smaller by the ratio that is found, this test would fail.
TEST(CoplanarityCubic, errors_reach_a_quarter_of_the_bound) {
  Random random(37);
  double max_ratio = 0;
  for (int start = 0; start < 60; ++start) {
    std::vector<double> numbers(26);
    for (double& x : numbers) x = random.uniform(-1, 1);
    max_ratio = std::max(max_ratio, climb(numbers, random, 1500, [](const std::vector<double>& v) {
                           Corners x;
                           for (int i = 0; i < 24; ++i) x[i / 3][i % 3] = v[i];
                           const auto time = [](double t) { return std::min(std::abs(t), 1.0); };
                           return ratio_to_bound(x, time(v[24]), time(v[25]));
                         }));
  }
  test::record("largest error over its bound", max_ratio);
  EXPECT_LE(max_ratio, 1);
  EXPECT_GT(max_ratio, 0.25);
}

/// d·A between the ends of the step, for numbers whose rounding errors were made to add up.
TEST(Separation, errors_of_dot_products_stay_within_the_bound_and_reach_a_quarter_of_it) {
  Random random(41);
  double max_ratio = 0;
  // v: d, the corner and the point at both ends, the time
  const auto ratio = [](const std::vector<double>& v) {
    const std::array<double, 3> d{v[0], v[1], v[2]};
    const double t = std::min(std::abs(v[15]), 1.0);
    double bound[2], a[2][3];
    Quad truth = 0, allowed = 0;
    for (int end = 0; end < 2; ++end) {
      const Quad weight = end == 1 ? static_cast<Quad>(t) : 1 - static_cast<Quad>(t);
      for (int k = 0; k < 3; ++k) {
        const double corner = v[3 + 6 * end + k], point = v[6 + 6 * end + k];
        a[end][k] = corner - point;
        const Quad term = static_cast<Quad>(d[k]) * (static_cast<Quad>(corner) - point);
        truth += weight * term;
        allowed += weight * (term < 0 ? -term : term) * 10 * 0x1p-53;
      }
      bound[end] = ccd::detail::lower_bound(d, a[end]);
    }
    const Quad computed = static_cast<Quad>((1 - t) * bound[0] + t * bound[1]);
    // 0 where the bound has all of its margin, 1 where nothing is left of it.
    return static_cast<double>((computed - truth + allowed) / allowed);
  };
  for (int start = 0; start < 100; ++start) {
    std::vector<double> numbers(16);
    for (double& x : numbers) x = random.uniform(-1, 1);
    max_ratio = std::max(max_ratio, climb(numbers, random, 2000, ratio));
  }
  test::record("largest error over its bound", max_ratio);
  EXPECT_LE(max_ratio, 1);
  EXPECT_GT(max_ratio, 0.25);
}

/// Coefficients on a sub-interval are those of the polynomial restricted to it: its ends are values.
TEST(CoplanarityCubic, sub_intervals_agree_with_values) {
  Random random(29);
  for (int i = 0; i < 2000; ++i) {
    const Corners x = families()[0].make(random);
    const ccd::detail::CoplanarityCubic cubic(to_motion(x), relative(x));
    const double a = random.uniform(0, 0.5), b = random.uniform(0.5, 1);
    const ccd::detail::Coefficients c = cubic.on({a, b});
    EXPECT_EQ(c.k[0], cubic.value(a));
    EXPECT_EQ(c.k[3], cubic.value(b));
    const double middle = (c.k[0] + 3 * c.k[1] + 3 * c.k[2] + c.k[3]) / 8;
    EXPECT_NEAR(middle, cubic.value(0.5 * (a + b)), 4 * cubic.error());
  }
}

}  // namespace
}  // namespace oilskin::test

#endif
