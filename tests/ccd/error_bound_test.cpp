// The error bound of the cubic, held against the true values in quadruple precision.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "ccd/coplanarity_cubic.h"
#include "ccd/queries.h"

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
    d[k] = start + t * (end - start);
  }
  return d;
}

Quad coplanarity(const Corners& x, double t) {
  const QuadVector e = difference_at(x, 2, 1, t), f = difference_at(x, 3, 1, t),
                   w = difference_at(x, 0, 1, t);
  return (e[1] * f[2] - e[2] * f[1]) * w[0] + (e[2] * f[0] - e[0] * f[2]) * w[1] +
         (e[0] * f[1] - e[1] * f[0]) * w[2];
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

/// Greatest observed error as a part of the bound: below 1 or the bound is wrong, not absurdly small or it is
/// dull.
TEST(CoplanarityCubic, ErrorsStayWithinTheBound) {
  Random random(23);
  double greatest = 0;
  for (int i = 0; i < 60000; ++i) {
    const Corners x = families()[i % 14].make(random);  // those within the range of quadruple precision
    const ccd::detail::CoplanarityCubic cubic(to_motion(x), relative(x));
    if (!cubic.bounded()) continue;
    for (const double t : {0.0, 1.0, 0.5, random.uniform(0, 1)}) {
      const Quad error = coplanarity(x, t) - static_cast<Quad>(cubic.value(t));
      greatest = std::max(greatest, std::abs(static_cast<double>(error)) / cubic.error());
    }
  }
  std::cout << "  greatest error " << greatest << " of the bound\n";
  EXPECT_LT(greatest, 1);
  EXPECT_GT(greatest, 0.01);
}

/// Coefficients on a sub-interval are those of the polynomial restricted to it: its ends are values.
TEST(CoplanarityCubic, SubIntervalsAgreeWithValues) {
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
