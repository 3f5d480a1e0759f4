#include "ccd/coplanarity_cubic.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

// The error bound 22 u P, with u = 2⁻⁵³ and the permanent P of (T.5), is derived in
// docs/theory/continuous_test.md, "Its error bound". Each term of a computed number goes through at most 21
// roundings; a change of the operations below changes their number. Underflow adds less than u P / 1000 if
// P > 1e-280 (1 + max |W|). An overflow makes a coefficient infinite or NaN.

namespace oilskin::ccd::detail {
namespace {

constexpr double error_factor = 22 * unit_roundoff;
constexpr double third = 1.0 / 3.0;

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
inline V max_magnitudes(const V& a, const V& b) {
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
  on_step_ = {
      {dot(n0, w0), (dot(n0, w1) + dot(nm, w0)) * third, (dot(n1, w0) + dot(nm, w1)) * third, dot(n1, w1)}};
  const V w = max_magnitudes(w0, w1);
  const double magnitude = permanent(max_magnitudes(e0, e1), max_magnitudes(f0, f1), w);
  error_ = error_factor * magnitude;
  const double* k = on_step_.k;
  const double sum_of_magnitudes = std::abs(k[0]) + std::abs(k[1]) + std::abs(k[2]) + std::abs(k[3]);
  bounded_ =
      magnitude > 1e-280 * (1 + std::max({w.x, w.y, w.z})) && magnitude < 1e290 && sum_of_magnitudes < 1e291;
}

Coefficients CoplanarityCubic::on(const TimeSpan& span) const {
  const double a = span.begin, b = span.end, s = 1 - a, r = 1 - b;
  const double* k = on_step_.k;
  const double a0 = lerp(k[0], k[1], s, a), a1 = lerp(k[1], k[2], s, a), a2 = lerp(k[2], k[3], s, a);
  const double aa0 = lerp(a0, a1, s, a), aa1 = lerp(a1, a2, s, a);
  const double ab0 = lerp(a0, a1, r, b), ab1 = lerp(a1, a2, r, b);
  const double b0 = lerp(k[0], k[1], r, b), b1 = lerp(k[1], k[2], r, b), b2 = lerp(k[2], k[3], r, b);
  const double bb0 = lerp(b0, b1, r, b), bb1 = lerp(b1, b2, r, b);
  return {{lerp(aa0, aa1, s, a), lerp(aa0, aa1, r, b), lerp(ab0, ab1, r, b), lerp(bb0, bb1, r, b)}};
}

double CoplanarityCubic::value_and_slope(double t, double* slope) const {
  const double s = 1 - t;
  const double* k = on_step_.k;
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
  constexpr int max_iterations = 60;
  const int sign_before = cubic.sign(cubic.value(bracket.begin));
  OILSKIN_ASSERT(sign_before != 0 && sign_before == -cubic.sign(cubic.value(bracket.end)));
  double t = bracket.middle(), slope = 0;
  for (int i = 0; i < max_iterations; ++i) {
    const double value = cubic.value_and_slope(t, &slope);
    const int sign = cubic.sign(value);
    if (sign == 0) break;
    (sign == sign_before ? bracket.begin : bracket.end) = t;
    const double newton = t - value / slope;
    const bool inside = newton > bracket.begin && newton < bracket.end;
    // Every eighth iteration is a bisection, against slow convergence.
    t = inside && i % 8 != 7 ? newton : bracket.middle();
  }
  // t is a root within rounding. Search for certain signs close to it; if there are none the bracket remains.
  double reach = 8 * unit_roundoff + 3 * cubic.error() / std::abs(slope);
  for (int i = 0; i < 6 && reach < bracket.width(); ++i, reach *= 8) {
    const double before = t - reach, after = t + reach;
    if (before > bracket.begin && cubic.sign(cubic.value(before)) == sign_before) bracket.begin = before;
    if (after < bracket.end && cubic.sign(cubic.value(after)) == -sign_before) bracket.end = after;
    if (bracket.width() <= 2 * reach) break;
  }
  OILSKIN_ASSERT(bracket.begin < bracket.end);
  return bracket;
}

}  // namespace oilskin::ccd::detail
