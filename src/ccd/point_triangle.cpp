#include "ccd/point_triangle.h"

#include <algorithm>
#include <cmath>

#include "ccd/coplanarity_cubic.h"
#include "ccd/exact_query.h"
#include "ccd/filter.h"
#include "ccd/separation.h"
#include "core/assert.h"

// The filter of docs/theory/continuous_test.md. "Apart" follows from the cubic's error bound (the four points
// are never coplanar), from a certain crossing of the plane outside the triangle, or from a direction that
// separates point and triangle by more than the rounding error of its dot products. "Impact" follows from a
// certain crossing inside the triangle. Exact determinants decide touches at an end of the step. The first
// part of the step that none of these decides goes to exact arithmetic.

namespace oilskin::ccd {
namespace {

using detail::Coefficients;
using detail::CoplanarityCubic;
using detail::ExactLocation;
using detail::FilterResult;
using detail::RelativeMotion;
using detail::TimeSpan;
using detail::Verdict;

/// (T.2). Fills `relative` axis by axis; true as soon as an axis separates. The six signs are exact, and a
/// linear function with one sign at both ends has it in between, so no error analysis is needed.
bool axis_separates(const PointTriangleMotion& m, RelativeMotion* relative) {
  for (int k = 0; k < 3; ++k) {
    const double p0 = m.p_t0[k], p1 = m.p_t1[k];
    const double a0 = m.a_t0[k] - p0, b0 = m.b_t0[k] - p0, c0 = m.c_t0[k] - p0;
    const double a1 = m.a_t1[k] - p1, b1 = m.b_t1[k] - p1, c1 = m.c_t1[k] - p1;
    const double low = std::min(std::min(std::min(a0, b0), std::min(c0, a1)), std::min(b1, c1));
    const double high = std::max(std::max(std::max(a0, b0), std::max(c0, a1)), std::max(b1, c1));
    // std::min and std::max may pass over a NaN, so they cannot show that there is none.
    if ((low > 0 || high < 0) && !std::isnan(a0 + b0 + c0 + a1 + b1 + c1)) return true;
    relative->t0[0][k] = a0;
    relative->t0[1][k] = b0;
    relative->t0[2][k] = c0;
    relative->t1[0][k] = a1;
    relative->t1[1][k] = b1;
    relative->t1[2][k] = c1;
  }
  return false;
}

/// Number of roots by the signs of the coefficients (Descartes' rule for the Bernstein basis; (T.7), (T.8)).
/// below_error: all coefficients are within the error bound.
enum class Roots { none, one, unknown, below_error };

Roots count_roots(const CoplanarityCubic& cubic, const Coefficients& c) {
  const int s0 = cubic.sign(c.k[0]), s1 = cubic.sign(c.k[1]), s2 = cubic.sign(c.k[2]),
            s3 = cubic.sign(c.k[3]);
  const int total = s0 + s1 + s2 + s3;
  if (total == 4 || total == -4) return Roots::none;
  // One variation, whatever the sign of an uncertain coefficient: exactly one root, and it is simple.
  if (s0 * s3 == -1 && (s1 == s0 || s2 == s3)) return Roots::one;
  if (s0 == 0 && s1 == 0 && s2 == 0 && s3 == 0) return Roots::below_error;
  return Roots::unknown;
}

/// Twice the areas spanned by the point and each edge, projected along axis k (T.9).
void projected_areas(const double corner[3][3], int k, double area[3]) {
  const int x = (k + 1) % 3, y = (k + 2) % 3;
  for (int i = 0; i < 3; ++i) {
    const double *a = corner[(i + 1) % 3], *b = corner[(i + 2) % 3];
    area[i] = a[x] * b[y] - a[y] * b[x];
  }
}

/// Location of the point relative to the triangle at the times of a span at which they are coplanar.
enum class Location { inside, outside, unclear };

/// A component computed for the middle of a span of width w is within η = (w + 8 u) M (T.10) of the true one
/// at any time of the span, with M the largest component at the ends of the step: 4 u M from roundings
/// (input, 1 − t, product, sum), M (w + 4 u) from the motion. With m the largest computed component, an area
/// (two products) is within 4 m η + 2 η² + 4 u m² ≤ 8 m η (T.11) of the true one, unless η > m/4; but then 8
/// m η exceeds any area. In the plane, the three areas on an axis are the triangle's area times the
/// barycentric weights of the point: certainly of one sign, the point is inside; two of different signs, it
/// is outside.
Location locate_point(const RelativeMotion& motion, const TimeSpan& span) {
  const double t = span.middle(), s = 1 - t;
  double corner[3][3], max_at_ends = 0, max_component = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double start = motion.t0[i][k], end = motion.t1[i][k];
      corner[i][k] = s * start + t * end;
      max_at_ends = std::max(max_at_ends, std::max(std::abs(start), std::abs(end)));
      max_component = std::max(max_component, std::abs(corner[i][k]));
    }
  }
  constexpr double underflow = 1e-300;
  const double deviation = (span.width() + 8 * detail::unit_roundoff) * max_at_ends;
  const double error = 8.001 * max_component * deviation + underflow;
  for (int k = 0; k < 3; ++k) {
    double area[3];
    projected_areas(corner, k, area);
    const double min_area = std::min(std::min(area[0], area[1]), area[2]);
    const double max_area = std::max(std::max(area[0], area[1]), area[2]);
    if (min_area > error || max_area < -error) return Location::inside;
    if (min_area < -error && max_area > error) return Location::outside;
  }
  return Location::unclear;
}

/// The time of impact in a span of at most this width is the beginning of the span.
constexpr double short_span = 0x1p-24;

struct Query {
  const PointTriangleMotion& exact;
  const RelativeMotion& motion;
  const CoplanarityCubic& cubic;
};

/// For a span in which the cubic may have any number of roots.
FilterResult test_separation(const RelativeMotion& motion, const TimeSpan& span) {
  if (span.width() <= short_span) {
    const bool outside = locate_point(motion, span) == Location::outside;
    return {outside ? Verdict::apart : Verdict::unclear, span};
  }
  return {certainly_apart(motion, span) ? Verdict::apart : Verdict::unclear, span};
}

/// Does the single crossing of the plane in `span` pass through the triangle?
FilterResult impact_at_crossing(const Query& query, const TimeSpan& span) {
  const TimeSpan root = narrow_crossing(query.cubic, span);
  if (root.width() > short_span) return test_separation(query.motion, root);
  const Location location = locate_point(query.motion, root);
  if (location == Location::unclear) return {Verdict::unclear, root};
  return {location == Location::inside ? Verdict::impact : Verdict::apart, root};
}

/// `span` is short and reaches an end of the step. The cubic certainly has `sign` in all of it but that end.
FilterResult test_end(const Query& query, const TimeSpan& span, int sign) {
  if (locate_point(query.motion, span) == Location::outside) return {};
  const int end = span.begin == 0 ? 0 : 1;
  switch (detail::exact_location(query.exact, end)) {
    case ExactLocation::inside:
      return {Verdict::impact, {static_cast<double>(end), static_cast<double>(end)}};
    case ExactLocation::outside:
      return {};
    case ExactLocation::positive_side:
      return {sign > 0 ? Verdict::apart : Verdict::unclear, span};
    case ExactLocation::negative_side:
      return {sign < 0 ? Verdict::apart : Verdict::unclear, span};
    case ExactLocation::unknown:
      break;
  }
  return {Verdict::unclear, span};
}

/// All coefficients but the first or the last have one certain sign: the only possible touch is at that end
/// of the span.
struct EndTouch {
  int at_begin = 0, at_end = 0;  ///< that sign, or 0
};

EndTouch end_touch(const CoplanarityCubic& cubic, const Coefficients& c) {
  const int s0 = cubic.sign(c.k[0]), s1 = cubic.sign(c.k[1]), s2 = cubic.sign(c.k[2]),
            s3 = cubic.sign(c.k[3]);
  if (s1 != s2) return {};
  return {s0 == 0 && s3 == s1 ? s1 : 0, s3 == 0 && s0 == s1 ? s1 : 0};
}

/// The time at which a span is cut whose roots cannot be counted: the middle, or for a touch at one end as
/// close to that end as the sign is certain. At a fraction x of the span the cubic exceeds
/// 3 x (1 − x)² |k| − error, with k the coefficient beside that end.
double choose_cut(const CoplanarityCubic& cubic, const Coefficients& c, const TimeSpan& span,
                  const EndTouch& touch) {
  const auto width = [&](double k) {
    const double certain = 4 * cubic.error() / std::abs(k) * span.width();
    return std::min(std::max(0.75 * short_span, certain), 0.5 * span.width());
  };
  if (touch.at_end != 0) return span.end - width(c.k[2]);
  if (touch.at_begin != 0) return span.begin + width(c.k[1]);
  return span.middle();
}

/// Isolates the roots of the cubic from the earliest to the latest, and ends at the first impact or undecided
/// span.
FilterResult first_result(const Query& query, const TimeSpan& span, const Coefficients& coefficients) {
  const CoplanarityCubic& cubic = query.cubic;
  switch (count_roots(cubic, coefficients)) {
    case Roots::none:
      return {};
    case Roots::one:
      return impact_at_crossing(query, span);
    case Roots::below_error:
      return test_separation(query.motion, span);
    case Roots::unknown:
      break;
  }
  const EndTouch touch = end_touch(cubic, coefficients);
  if (span.width() <= short_span) {
    if (touch.at_end != 0 && span.end == 1) return test_end(query, span, touch.at_end);
    if (touch.at_begin != 0 && span.begin == 0) return test_end(query, span, touch.at_begin);
    return test_separation(query.motion, span);
  }
  const double cut = choose_cut(cubic, coefficients, span, touch);
  OILSKIN_ASSERT(span.begin < cut && cut < span.end);
  const TimeSpan early{span.begin, cut}, late{cut, span.end};
  const FilterResult result = first_result(query, early, cubic.on(early));
  if (result.verdict != Verdict::apart) return result;
  return first_result(query, late, cubic.on(late));
}

}  // namespace

detail::FilterResult detail::filter(const PointTriangleMotion& m) {
  RelativeMotion relative;
  if (axis_separates(m, &relative)) return {};
  const CoplanarityCubic cubic(m, relative);
  if (!cubic.bounded()) return test_separation(relative, {0, 1});
  return first_result({m, relative, cubic}, {0, 1}, cubic.coefficients());
}

Impact point_triangle(const PointTriangleMotion& m) {
  const FilterResult result = detail::filter(m);
  const TimeSpan& span = result.span;
  OILSKIN_ASSERT(0 <= span.begin && span.begin <= span.end && span.end <= 1);
  if (result.verdict == Verdict::apart) return {};
  if (result.verdict == Verdict::impact) return {true, span.begin};
  return span.width() <= short_span ? detail::exact_impact_from(m, span) : detail::exact_impact(m);
}

}  // namespace oilskin::ccd
