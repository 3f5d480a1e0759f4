// The library's exact arithmetic against the oracle's.
#include "ccd/big_integer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "ccd/integer_polynomials.h"
#include "ccd/queries.h"
#include "support/exact.h"

namespace oilskin::test {
namespace {

using ccd::detail::Algebra;
using ccd::detail::BigInteger;
using ccd::detail::Function;
using ccd::detail::Polynomial;
using ccd::detail::RoundedPolynomial;
using ccd::detail::Surd;
using ccd::detail::Workspace;
using exact::Integer;

Integer to_integer(const BigInteger& a) {
  Integer x;
  for (int i = a.size - 1; i >= 0; --i) {
    for (int shift = ccd::detail::limb_bits - 16; shift >= 0; shift -= 16) {
      x = (x << 16) + Integer(static_cast<std::int64_t>((a.limbs[i] >> shift) & 0xffff));
    }
  }
  return a.sign < 0 ? -x : x;
}

/// Integers up to 2^600, sparse and dense.
double integral_double(Random& random) {
  const double mantissa =
      random.integer(0, 3) == 0 ? random.integer(-3, 3) : std::floor(random.uniform(-0x1p53, 0x1p53));
  return std::ldexp(mantissa, random.integer(0, 547));
}

TEST(BigIntegers, agree_with_the_oracles_integers) {
  const auto workspace = std::make_unique<Workspace>();
  Random random(31);
  for (int i = 0; i < 20000; ++i) {
    const Workspace::Scope scope(workspace.get());
    const double x = integral_double(random), y = integral_double(random), z = integral_double(random);
    const BigInteger a = workspace->from_double(x, 0), b = workspace->from_double(y, 0),
                     c = workspace->from_double(z, 0);
    const Integer p = Integer::from_double(x, 0), q = Integer::from_double(y, 0),
                  r = Integer::from_double(z, 0);
    ASSERT_TRUE(to_integer(a) == p);
    ASSERT_TRUE(to_integer(workspace->sum(workspace->product(a, b), c)) == p * q + r);
    const BigInteger difference = workspace->difference(workspace->product(a, b), workspace->product(b, c));
    ASSERT_TRUE(to_integer(difference) == p * q - q * r);
    ASSERT_EQ(difference.sign, (p * q - q * r).sign());
    const ccd::detail::Scaled rounded = approximation(a);
    ASSERT_NEAR(std::ldexp(rounded.mantissa, rounded.exponent) / (x == 0 ? 1 : x), x == 0 ? 0 : 1, 0x1p-50);
  }
  EXPECT_FALSE(workspace->exhausted());
}

#ifdef OILSKIN_CCD_WIDE_INTEGERS
using ccd::detail::WideInteger;

template <int N>
Integer to_integer(const WideInteger<N>& a) {
  Integer x(static_cast<std::int64_t>(a.limb[N - 1]));  // the sign is in the last limb
  for (int i = N - 2; i >= 0; --i) {
    for (int shift = 48; shift >= 0; shift -= 16)
      x = (x << 16) + Integer(static_cast<std::int64_t>((a.limb[i] >> shift) & 0xffff));
  }
  return x;
}

TEST(WideInteger, agrees_with_the_oracles_integers) {
  const auto workspace = std::make_unique<Workspace>();
  Random random(37);
  const auto draw = [&random] {
    const double x = std::floor(std::abs(random.uniform(0, 1)) * std::ldexp(1, random.integer(0, 53)));
    return ccd::detail::wide_from(static_cast<std::uint64_t>(x), random.integer(0, 71),
                                  random.integer(0, 1) == 1);
  };
  for (int i = 0; i < 20000; ++i) {
    const Workspace::Scope scope(workspace.get());
    const WideInteger<2> a = draw(), b = draw(), c = draw(), d = draw();
    const Integer p = to_integer(a), q = to_integer(b), r = to_integer(c), s = to_integer(d);
    ASSERT_TRUE(to_integer(a + b) == p + q);
    const WideInteger<4> area = a * b - c * d;
    ASSERT_TRUE(to_integer(area) == p * q - r * s);
    const WideInteger<6> volume = (a - c) * area;
    ASSERT_TRUE(to_integer(volume) == (p - r) * (p * q - r * s));
    ASSERT_EQ(volume.sign(), to_integer(volume).sign());
    ASSERT_TRUE(to_integer(workspace->from_wide(volume)) == to_integer(volume));
  }
}
#endif

TEST(BigIntegers, hold_every_finite_double) {
  const auto workspace = std::make_unique<Workspace>();
  const BigInteger maximum = workspace->from_double(std::numeric_limits<double>::max(), -1074),
                   minimum = workspace->from_double(-0x1p-1074, -1074);
  EXPECT_TRUE(to_integer(maximum) == Integer::from_double(std::numeric_limits<double>::max(), 1074));
  EXPECT_TRUE(to_integer(minimum) == Integer(-1));
  EXPECT_EQ(ccd::detail::decompose(-12).exponent, 2);
  EXPECT_EQ(ccd::detail::decompose(0x1p-1074).exponent, -1074);
}

TEST(BigIntegers, a_full_block_is_reported) {
  const auto workspace = std::make_unique<Workspace>();
  BigInteger a = workspace->from_double(0x1p1000, 0);
  for (int i = 0; i < 20; ++i) a = workspace->product(a, a);
  EXPECT_TRUE(workspace->exhausted());
  EXPECT_EQ(a.sign, 0);
}

Polynomial polynomial(Workspace* workspace, const std::array<int, 4>& c) {
  Polynomial f;
  for (int i = 0; i < 4; ++i) {
    f.c[i] = workspace->small(c[i]);
    if (c[i] != 0) f.degree = i;
  }
  return f;
}

/// (2 t − 1)(t² + t − 1) has the roots ½ and the inverse of the golden ratio, a root of the quadratic.
TEST(BigIntegers, signs_at_surds_are_exact) {
  const auto workspace = std::make_unique<Workspace>();
  Algebra algebra(workspace.get());
  const Function golden(polynomial(workspace.get(), {-1, 1, 1, 0})),
      cubic(polynomial(workspace.get(), {1, -3, 1, 2}));
  const auto roots = algebra.roots_of(golden.exact);
  ASSERT_EQ(roots.count, 2);
  const double ratio = 0.61803398874989484820;
  EXPECT_NEAR(roots.at[1].approximate, ratio, 0x1p-47);
  EXPECT_NEAR(roots.at[0].approximate, -1 / ratio, 0x1p-46);
  EXPECT_EQ(algebra.sign_at(golden, roots.at[1]), 0);
  EXPECT_EQ(algebra.sign_at(cubic, roots.at[1]), 0);
  const Surd half = algebra.fraction(workspace->small(-3), workspace->small(-6));
  EXPECT_EQ(algebra.sign_at(cubic, half), 0);
  EXPECT_EQ(algebra.sign_at(golden, half), -1);
  EXPECT_EQ(algebra.compare_with_fraction(roots.at[1], half), 1);
  EXPECT_EQ(algebra.compare_with_fraction(roots.at[0], half), -1);
  EXPECT_EQ(algebra.compare_with_fraction(half, half), 0);
  // The convergents of the golden ratio lie on either side, ever closer.
  for (int a = 1, b = 1, side = 1; b < 1000000000; std::swap(a, b), b += a, side = -side) {
    const Surd t = algebra.fraction(workspace->small(a), workspace->small(b));
    EXPECT_EQ(algebra.sign_at(golden, t), side);
    EXPECT_EQ(algebra.compare_with_fraction(roots.at[1], t), -side);
  }
}

/// 27 (t − ⅓)³ on about [⅓ − 2⁻³⁰, ⅓ + 2⁻³⁰]: its values are below rounding as a polynomial in t, but not as
/// one in s.
TEST(BigIntegers, stretched_polynomials_keep_their_signs) {
  const auto workspace = std::make_unique<Workspace>();
  Algebra algebra(workspace.get());
  const Function cubic(polynomial(workspace.get(), {-1, 9, -27, 27}));
  constexpr double kGrid = 0x1p52, kWidth = 0x1p23;
  const double start = std::floor(kGrid / 3) - 0x1p22;
  const auto integer = [&](double x) { return workspace->from_double(x, 0); };
  const Polynomial on_part =
      algebra.reparametrised(cubic.exact, integer(start), integer(kWidth), integer(kGrid));
  const RoundedPolynomial rounded(on_part);
  int certain = 0;
  for (int i = 0; i <= 1024; ++i) {
    const double s = i / 1024.0, t = (start + s * kWidth) / kGrid;
    EXPECT_EQ(cubic.rounded.sign_between(t, t), 0);
    const int sign = rounded.sign_between(s, s);
    const Surd exact = algebra.fraction(integer(start + s * kWidth), integer(kGrid));
    EXPECT_TRUE(sign == 0 || sign == algebra.sign_at(cubic, exact)) << i;
    certain += sign != 0 ? 1 : 0;
  }
  EXPECT_GE(certain, 1020);
  EXPECT_EQ(algebra.reparametrised({}, integer(1), integer(1), integer(1)).degree, -1);
  // 1 + 2 t on [3, 5] / 4 is (10 + 4 s) / 4.
  const Polynomial line =
      algebra.reparametrised(polynomial(workspace.get(), {1, 2, 0, 0}), integer(3), integer(2), integer(4));
  ASSERT_EQ(line.degree, 1);
  EXPECT_EQ(compare_magnitudes(line.c[0], integer(10)), 0);
  EXPECT_EQ(compare_magnitudes(line.c[1], integer(4)), 0);
}

}  // namespace
}  // namespace oilskin::test
