#include "ccd/point_triangle.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "ccd/coplanarity_cubic.h"
#include "ccd/exact_query.h"
#include "ccd/filter.h"
#include "ccd/separation.h"
#include "core/assert.h"

// The method. Plain arithmetic answers what it can with certainty: "apart" by a bound of the cubic's rounding
// error (the four points are never coplanar), by a certain crossing of the plane beside the triangle, or by a
// direction that separates point and triangle beyond the rounding error of its dot products; "meet" by a
// certain crossing within the triangle. Touches at an end of the step are placed by exact determinants. The
// first part of the step that none of this decides goes to exact arithmetic: with no more than a question
// whether it touches, if the part is short.

namespace oilskin::ccd {
namespace {

using detail::Coefficients;
using detail::CoplanarityCubic;
using detail::FilterResult;
using detail::Placement;
using detail::RelativeMotion;
using detail::TimeSpan;
using detail::Verdict;

static_assert(sizeof(PointTriangleMotion) == 24 * sizeof(double), "end points are compared as one block");

bool nothing_moves(const PointTriangleMotion& m) {
  const double *start = m.p_t0.data(), *end = m.p_t1.data();
  // The point alone decides nearly always. Bits are compared, so that +0 and −0 differ.
  // NOLINTBEGIN(bugprone-suspicious-memory-comparison)
  return std::memcmp(start, end, 3 * sizeof(double)) == 0 &&
         std::memcmp(start, end, 12 * sizeof(double)) == 0;
  // NOLINTEND(bugprone-suspicious-memory-comparison)
}

/// (T.2). Fills `relative` axis by axis; true as soon as an axis separates. The six signs are exact, and what
/// has one sign at both ends of a linear motion has it in between: no error analysis needed.
bool axis_separates(const PointTriangleMotion& m, RelativeMotion* relative) {
  for (int k = 0; k < 3; ++k) {
    const double p0 = m.p_t0[k], p1 = m.p_t1[k];
    const double a0 = m.a_t0[k] - p0, b0 = m.b_t0[k] - p0, c0 = m.c_t0[k] - p0;
    const double a1 = m.a_t1[k] - p1, b1 = m.b_t1[k] - p1, c1 = m.c_t1[k] - p1;
    const double minimum = std::min(std::min(std::min(a0, b0), std::min(c0, a1)), std::min(b1, c1));
    const double maximum = std::max(std::max(std::max(a0, b0), std::max(c0, a1)), std::max(b1, c1));
    if (minimum > 0 || maximum < 0) return true;
    relative->t0[0][k] = a0;
    relative->t0[1][k] = b0;
    relative->t0[2][k] = c0;
    relative->t1[0][k] = a1;
    relative->t1[1][k] = b1;
    relative->t1[2][k] = c1;
  }
  return false;
}

/// How the signs of the coefficients limit the number of roots (Descartes' rule for the Bernstein basis;
/// (T.7), (T.8)).
enum class Roots { kNone, kOne, kUnknown, kInvisible };

Roots count_roots(const CoplanarityCubic& cubic, const Coefficients& c) {
  const int s0 = cubic.sign(c.k[0]), s1 = cubic.sign(c.k[1]), s2 = cubic.sign(c.k[2]),
            s3 = cubic.sign(c.k[3]);
  const int total = s0 + s1 + s2 + s3;
  if (total == 4 || total == -4) return Roots::kNone;
  // One variation of sign whatever the sign of the uncertain coefficient: exactly one root, and it is simple.
  if (s0 * s3 == -1 && (s1 == s0 || s2 == s3)) return Roots::kOne;
  if (s0 == 0 && s1 == 0 && s2 == 0 && s3 == 0) return Roots::kInvisible;
  return Roots::kUnknown;
}

/// Twice the areas of point and edges, projected along axis k (T.9).
void projected_areas(const double corner[3][3], int k, double area[3]) {
  const int x = (k + 1) % 3, y = (k + 2) % 3;
  for (int i = 0; i < 3; ++i) {
    const double *a = corner[(i + 1) % 3], *b = corner[(i + 2) % 3];
    area[i] = a[x] * b[y] - a[y] * b[x];
  }
}

/// Where the point is at those times within a span at which the four points are coplanar.
enum class Place { kInside, kOutside, kUnclear };

/// With M the largest component at the ends of the step, a component computed for the middle of a span of
/// half width h is within δ = (2 h + 8 u) M (T.10) of the true one at any time of the span: 4 u M from
/// roundings (input, 1 − t, product, sum), 2 M (h + 2 u) from the motion. With m the largest computed
/// component, an area (two products) is within 4 m δ + 2 δ² + 4 u m² ≤ 8 m δ (T.11) of the true one, unless δ
/// > m/4; but then 8 m δ exceeds any area. In the plane, the three areas on an axis are that of the triangle
/// times the point's weights: all of one sign for certain, the point is inside; two of different signs, it is
/// outside.
Place place_of_point(const RelativeMotion& motion, const TimeSpan& span) {
  const double t = span.middle(), s = 1 - t;
  double corner[3][3], max_at_ends = 0, maximum = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double start = motion.t0[i][k], end = motion.t1[i][k];
      corner[i][k] = s * start + t * end;
      max_at_ends = std::max(max_at_ends, std::max(std::abs(start), std::abs(end)));
      maximum = std::max(maximum, std::abs(corner[i][k]));
    }
  }
  constexpr double kUnderflow = 1e-300;
  const double deviation = (span.width() + 8 * detail::kUnitRoundoff) * max_at_ends;
  const double error = 8.001 * maximum * deviation + kUnderflow;
  for (int k = 0; k < 3; ++k) {
    double area[3];
    projected_areas(corner, k, area);
    const double min_area = std::min(std::min(area[0], area[1]), area[2]);
    const double max_area = std::max(std::max(area[0], area[1]), area[2]);
    if (min_area > error || max_area < -error) return Place::kInside;
    if (min_area < -error && max_area > error) return Place::kOutside;
  }
  return Place::kUnclear;
}

/// The touch of a span that is so short has its time: the beginning, early by less than anyone asks.
constexpr double kShort = 0x1p-24;

/// A query on its way through the tests.
struct Query {
  const PointTriangleMotion& exact;
  const RelativeMotion& motion;
  const CoplanarityCubic& cubic;
};

/// A span in which the cubic may vanish, once or more often.
FilterResult judge(const RelativeMotion& motion, const TimeSpan& span) {
  if (span.width() <= kShort) {
    const bool outside = place_of_point(motion, span) == Place::kOutside;
    return {outside ? Verdict::kApart : Verdict::kUnclear, span};
  }
  return {certainly_apart(motion, span) ? Verdict::kApart : Verdict::kUnclear, span};
}

/// The single crossing of the plane within `span`: through the triangle or beside it?
FilterResult impact_at_crossing(const Query& query, const TimeSpan& span) {
  const TimeSpan root = narrow_crossing(query.cubic, span);
  if (root.width() > kShort) return judge(query.motion, root);
  const Place place = place_of_point(query.motion, root);
  if (place == Place::kUnclear) return {Verdict::kUnclear, root};
  return {place == Place::kInside ? Verdict::kImpact : Verdict::kApart, root};
}

/// The cubic has a certain sign in all of the short `span` but at one end of it, which is that of the step.
FilterResult judge_end(const Query& query, const TimeSpan& span, int sign) {
  if (place_of_point(query.motion, span) == Place::kOutside) return {};
  const int end = span.begin == 0 ? 0 : 1;
  switch (detail::exact_placement(query.exact, end)) {
    case Placement::kInside:
      return {Verdict::kImpact, {static_cast<double>(end), static_cast<double>(end)}};
    case Placement::kOutside:
      return {};
    case Placement::kPositiveSide:
      return {sign > 0 ? Verdict::kApart : Verdict::kUnclear, span};
    case Placement::kNegativeSide:
      return {sign < 0 ? Verdict::kApart : Verdict::kUnclear, span};
    case Placement::kUnknown:
      break;
  }
  return {Verdict::kUnclear, span};
}

/// The sign of all coefficients but the first or the last, which is uncertain: a touch at one end of the
/// span.
struct EndTouch {
  int at_begin = 0, at_end = 0;  ///< the sign, or 0
};

EndTouch end_touch(const CoplanarityCubic& cubic, const Coefficients& c) {
  const int s0 = cubic.sign(c.k[0]), s1 = cubic.sign(c.k[1]), s2 = cubic.sign(c.k[2]),
            s3 = cubic.sign(c.k[3]);
  if (s1 != s2) return {};
  return {s0 == 0 && s3 == s1 ? s1 : 0, s3 == 0 && s0 == s1 ? s1 : 0};
}

/// Where to cut a span whose roots cannot be counted. In the middle; but for a touch at one end, as close to
/// it as the sign is certain: the coefficient k beside it keeps the cubic beyond 3 x (1 − x)² |k| − error at
/// a part x of the span.
double choose_cut(const CoplanarityCubic& cubic, const Coefficients& c, const TimeSpan& span,
                  const EndTouch& touch) {
  const auto part = [&](double beside) {
    const double certain = 4 * cubic.error() / std::abs(beside) * span.width();
    return std::min(std::max(0.75 * kShort, certain), 0.5 * span.width());
  };
  if (touch.at_end != 0) return span.end - part(c.k[2]);
  if (touch.at_begin != 0) return span.begin + part(c.k[1]);
  return span.middle();
}

/// Isolates the roots of the cubic from the earliest to the latest, and ends at the first that meets or
/// cannot be judged.
FilterResult first_result(const Query& query, const TimeSpan& span, const Coefficients& coefficients) {
  const CoplanarityCubic& cubic = query.cubic;
  switch (count_roots(cubic, coefficients)) {
    case Roots::kNone:
      return {};
    case Roots::kOne:
      return impact_at_crossing(query, span);
    case Roots::kInvisible:
      return judge(query.motion, span);
    case Roots::kUnknown:
      break;
  }
  const EndTouch touch = end_touch(cubic, coefficients);
  if (span.width() <= kShort) {
    if (touch.at_end != 0 && span.end == 1) return judge_end(query, span, touch.at_end);
    if (touch.at_begin != 0 && span.begin == 0) return judge_end(query, span, touch.at_begin);
    return judge(query.motion, span);
  }
  const double cut = choose_cut(cubic, coefficients, span, touch);
  OILSKIN_ASSERT(span.begin < cut && cut < span.end);
  const TimeSpan early{span.begin, cut}, late{cut, span.end};
  const FilterResult finding = first_result(query, early, cubic.on(early));
  if (finding.verdict != Verdict::kApart) return finding;
  return first_result(query, late, cubic.on(late));
}

}  // namespace

detail::FilterResult detail::filter(const PointTriangleMotion& m) {
  if (nothing_moves(m)) return {};
  RelativeMotion relative;
  if (axis_separates(m, &relative)) return {};
  const CoplanarityCubic cubic(m, relative);
  if (!cubic.bounded()) return judge(relative, {0, 1});
  return first_result({m, relative, cubic}, {0, 1}, cubic.coefficients());
}

Impact point_triangle(const PointTriangleMotion& m) {
  const FilterResult finding = detail::filter(m);
  const TimeSpan& span = finding.span;
  OILSKIN_ASSERT(0 <= span.begin && span.begin <= span.end && span.end <= 1);
  if (finding.verdict == Verdict::kApart) return {};
  if (finding.verdict == Verdict::kImpact) return {true, span.begin};
  return span.width() <= kShort ? detail::exact_impact_from(m, span) : detail::exact_impact(m);
}

}  // namespace oilskin::ccd
