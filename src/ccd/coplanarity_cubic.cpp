#include "ccd/coplanarity_cubic.h"

#include <algorithm>
#include <array>
#include <cmath>

// The error bound. u = 2⁻⁵³; a quantity that went through n roundings has a relative error of at most γn ≈ n
// u per product term, so the bound is n u times the sum of the magnitudes of all terms.
//
//   E1 = b − a, E2 = c − a, W = p − a     one rounding per component                                        1
//   N0 = E1⁰×E2⁰, N1 = E1¹×E2¹            two inputs, product, difference                          1+1+1+1 =
//   4 Nm = E1⁰×E2¹ + E1¹×E2⁰                one sum more 5 Nm·W0                                 input W,
//   product, two sums                                5+1+1+2 = 9 N0·W1 + Nm·W0, times the rounded 1/3  one
//   sum, one constant, one product                                12
//
// The magnitudes: each coefficient is a mean of determinants of rows taken from E1, E2, W at either end, so
// the sum of its terms' magnitudes is at most the permanent P of the matrix of componentwise maxima over both
// ends. Values, and coefficients on sub-intervals, are blossoms of the four coefficients: three levels of (1
// − t) x + t y, each with at most three roundings per term (1 − t, product, sum), of terms whose magnitudes
// sum to at most P: 9 more. In all 21 u P. P's own roundings (at most 9 u P relative) and the second-order
// terms are far below the u P that 22 u P leaves.
//
// Underflow: a product of two edges errs by 2⁻¹⁰⁷⁵ absolutely, which W magnifies; 12 of them and the later
// products stay below u P when P > 1e-280 (1 + max|W|).

namespace oilskin::ccd::detail {
namespace {

constexpr double kErrorFactor = 22 * kUnitRoundoff;
constexpr double kThird = 1.0 / 3.0;

struct V {
  double x, y, z;
};

inline V difference(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline V sum(const V& a, const V& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline double dot(const V& a, const V& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline V largest(const V& a, const V& b) {
  return {std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)),
          std::max(std::abs(a.z), std::abs(b.z))};
}
inline double permanent(const V& a, const V& b, const V& c) {
  return a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x);
}
inline double lerp(double x, double y, double s, double t) {
  return s * x + t * y;
}

}  // namespace

CoplanarityCubic::CoplanarityCubic(const PointTriangleMotion& m, const RelativeMotion& relative) {
  const V e0 = difference(m.b_t0, m.a_t0), e1 = difference(m.b_t1, m.a_t1);
  const V f0 = difference(m.c_t0, m.a_t0), f1 = difference(m.c_t1, m.a_t1);
  const V w0{-relative.t0[0][0], -relative.t0[0][1], -relative.t0[0][2]};
  const V w1{-relative.t1[0][0], -relative.t1[0][1], -relative.t1[0][2]};
  const V n0 = cross(e0, f0), n1 = cross(e1, f1), nm = sum(cross(e0, f1), cross(e1, f0));
  whole_ = {
      {dot(n0, w0), (dot(n0, w1) + dot(nm, w0)) * kThird, (dot(n1, w0) + dot(nm, w1)) * kThird, dot(n1, w1)}};
  const V w = largest(w0, w1);
  const double magnitude = permanent(largest(e0, e1), largest(f0, f1), w);
  error_ = kErrorFactor * magnitude;
  bounded_ = magnitude > 1e-280 * (1 + std::max({w.x, w.y, w.z})) && magnitude < 1e290;
}

Coefficients CoplanarityCubic::on(const TimeSpan& span) const {
  const double a = span.begin, b = span.end, s = 1 - a, r = 1 - b;
  const double* k = whole_.k;
  const double a0 = lerp(k[0], k[1], s, a), a1 = lerp(k[1], k[2], s, a), a2 = lerp(k[2], k[3], s, a);
  const double aa0 = lerp(a0, a1, s, a), aa1 = lerp(a1, a2, s, a);
  const double ab0 = lerp(a0, a1, r, b), ab1 = lerp(a1, a2, r, b);
  const double b0 = lerp(k[0], k[1], r, b), b1 = lerp(k[1], k[2], r, b), b2 = lerp(k[2], k[3], r, b);
  const double bb0 = lerp(b0, b1, r, b), bb1 = lerp(b1, b2, r, b);
  return {{lerp(aa0, aa1, s, a), lerp(aa0, aa1, r, b), lerp(ab0, ab1, r, b), lerp(bb0, bb1, r, b)}};
}

double CoplanarityCubic::value_and_slope(double t, double* slope) const {
  const double s = 1 - t;
  const double* k = whole_.k;
  const double a0 = lerp(k[0], k[1], s, t), a1 = lerp(k[1], k[2], s, t), a2 = lerp(k[2], k[3], s, t);
  const double b0 = lerp(a0, a1, s, t), b1 = lerp(a1, a2, s, t);
  *slope = 3 * (b1 - b0);
  return lerp(b0, b1, s, t);
}

double CoplanarityCubic::value(double t) const {
  double slope;
  return value_and_slope(t, &slope);
}

TimeSpan narrow_crossing(const CoplanarityCubic& cubic, TimeSpan bracket) {
  constexpr int kMaxIterations = 60;
  const int sign_before = cubic.sign(cubic.value(bracket.begin));
  double t = bracket.middle(), slope = 0;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double value = cubic.value_and_slope(t, &slope);
    const int sign = cubic.sign(value);
    if (sign == 0) break;
    (sign == sign_before ? bracket.begin : bracket.end) = t;
    const double newton = t - value / slope;
    const bool inside = newton > bracket.begin && newton < bracket.end;
    t = inside && i % 8 != 7 ? newton
                             : bracket.middle();  // now and then a bisection, against slow convergence
  }
  // t is a root as far as rounding can tell. Find certain signs close by; failing that the bracket stands.
  double reach = 8 * kUnitRoundoff + 3 * cubic.error() / std::abs(slope);
  for (int i = 0; i < 6 && reach < bracket.width(); ++i, reach *= 8) {
    const double before = t - reach, after = t + reach;
    if (before > bracket.begin && cubic.sign(cubic.value(before)) == sign_before) bracket.begin = before;
    if (after < bracket.end && cubic.sign(cubic.value(after)) == -sign_before) bracket.end = after;
    if (bracket.width() <= 2 * reach) break;
  }
  return bracket;
}

}  // namespace oilskin::ccd::detail
