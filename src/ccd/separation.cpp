#include "ccd/separation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/assert.h"

namespace oilskin::ccd::detail {
namespace {

using Direction = std::array<double, 3>;

Direction cross(const Direction& a, const Direction& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Direction minus(const Direction& a, const Direction& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The motion is linear, so d·A is linear in time: bounds at the ends bound it in between.
struct LinearBound {
  double t0, t1;

  double at_time(double t) const { return (1 - t) * t0 + t * t1; }
};

/// Shrinks the side of `part` on which `bound` is not positive; `inner` is a time at which it is. The
/// crossing is computed with rounding, so the new end is tested, and moved inwards until the test succeeds.
double last_positive(const LinearBound& bound, double inner, double outer) {
  if (bound.at_time(outer) > 0) return outer;
  constexpr double kSteps[] = {0x1p-48, 0x1p-40, 0x1p-20, 0x1p-4};
  const double crossing = bound.t0 / (bound.t0 - bound.t1);
  double t = std::max(std::min(crossing, std::max(inner, outer)), std::min(inner, outer));
  for (const double step : kSteps) {
    if (bound.at_time(t) > 0) return t;
    t += (inner - t) * step;
  }
  return bound.at_time(t) > 0 ? t : inner;
}

/// The part of `span` around `at` on which all corners are certainly on the side of the point to which d
/// points.
bool certify(const RelativeMotion& motion, const Direction& d, double at, const TimeSpan& span,
             TimeSpan* part) {
  std::array<LinearBound, 3> bounds;
  for (int i = 0; i < 3; ++i) {
    bounds[i] = {lower_bound(d, motion.t0[i]), lower_bound(d, motion.t1[i])};
    if (!(bounds[i].at_time(at) > 0)) return false;
  }
  *part = span;
  for (const LinearBound& bound : bounds) {
    part->begin = last_positive(bound, at, part->begin);
    part->end = last_positive(bound, at, part->end);
  }
  return true;
}

/// The triangle relative to the point at one time, with rounding: good enough to guess directions from.
std::array<Direction, 3> corners_at(const RelativeMotion& motion, double t) {
  std::array<Direction, 3> corner;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) corner[i][k] = (1 - t) * motion.t0[i][k] + t * motion.t1[i][k];
  }
  return corner;
}

/// Walks through the directions that can separate a point from a triangle: one per feature that may be
/// closest. `visit(d)` returns true to stop. Directions of edges come twice: perpendicular within the
/// triangle's plane (best at the plane), and from the point to the edge's line (good for segments and
/// slivers, whose normal is noise).
template <class Visit>
void for_each_candidate(const std::array<Direction, 3>& corner, Visit visit) {
  std::array<Direction, 3> edge;
  for (int i = 0; i < 3; ++i) edge[i] = minus(corner[(i + 1) % 3], corner[i]);
  const Direction normal = cross(edge[0], edge[1]);
  if (visit(normal)) return;
  for (int i = 0; i < 3; ++i) {
    if (visit(cross(normal, edge[i]))) return;
  }
  for (int i = 0; i < 3; ++i) {
    if (visit(cross(edge[i], cross(corner[i], edge[i])))) return;
  }
  for (int i = 0; i < 3; ++i) {
    if (visit(corner[i])) return;
  }
  // Dot products with an axis have no rounding error but that of the difference: they decide the finest gaps.
  for (int k = 0; k < 3; ++k) {
    Direction axis{};
    axis[k] = 1;
    if (visit(axis)) return;
  }
}

/// Scaled by a power of two so that the largest component is near 1: products of directions neither overflow
/// nor underflow. Scaling down may round components below 2⁻¹⁰²² times the largest; `lower_bound` allows for
/// that.
RelativeMotion scaled_to_unity(const RelativeMotion& motion) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      largest = std::max({largest, std::abs(motion.t0[i][k]), std::abs(motion.t1[i][k])});
    }
  }
  if ((largest > 0x1p-40 && largest < 0x1p40) || largest == 0 || !std::isfinite(largest)) return motion;
  const int exponent = -std::ilogb(largest);
  RelativeMotion scaled;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      scaled.t0[i][k] = std::ldexp(motion.t0[i][k], exponent);
      scaled.t1[i][k] = std::ldexp(motion.t1[i][k], exponent);
    }
  }
  return scaled;
}

/// Tries the directions that separate best at the time `guess`, keeps the one that reaches furthest around
/// `at`. True when it reaches over the whole span.
bool improve(const RelativeMotion& motion, double guess, double at, const TimeSpan& span, TimeSpan* best) {
  const std::array<Direction, 3> corner = corners_at(motion, guess);
  const Direction sum = {corner[0][0] + corner[1][0] + corner[2][0],
                         corner[0][1] + corner[1][1] + corner[2][1],
                         corner[0][2] + corner[1][2] + corner[2][2]};
  bool whole = false;
  for_each_candidate(corner, [&](Direction d) {
    // Any direction may be tried; pointing it at the triangle's centre saves testing both signs.
    if (dot(d, sum) < 0) d = {-d[0], -d[1], -d[2]};
    TimeSpan part;
    if (!certify(motion, d, at, span, &part)) return false;
    whole = part.begin <= span.begin && part.end >= span.end;
    if (whole || part.width() > best->width()) *best = part;
    return whole;
  });
  return whole;
}

}  // namespace

/// (T.12). Let S = Σ|d_k A_k| with the exact A. What a term of the computed dot product goes through, in
/// units of u S:
///
///   A itself, the product, two sums                                   4
///   the bound's subtraction from the sum                              1
///   `at_time`: 1 − t, the product, the sum (of terms up to S)         3
///                                                                     8
///
/// The computed S is smaller than S by four roundings at most, which is of second order like the products of
/// roundings: 10 u S covers all and is a cheap product. Each end spares its own 3 u S, and `at_time` weighs
/// both ends as it weighs their errors. The additive term covers underflow: a product errs by 2⁻¹⁰⁷⁵, and so
/// does a component of A that `scaled_to_unity` scales down, times |d| < 100 there.
double lower_bound(const std::array<double, 3>& d, const double* a) {
  constexpr double kUnderflow = 1e-300;
  const double x = d[0] * a[0], y = d[1] * a[1], z = d[2] * a[2];
  const double sum_of_magnitudes = std::abs(x) + std::abs(y) + std::abs(z);
  return (x + y + z) - (10 * kUnitRoundoff * sum_of_magnitudes + kUnderflow);
}

bool certainly_apart(const RelativeMotion& original, const TimeSpan& whole) {
  // Enough for what turns while it slides past; what needs more is decided faster by exact arithmetic.
  constexpr int kMaxNodes = 4;
  const RelativeMotion motion = scaled_to_unity(original);
  std::array<TimeSpan, kMaxNodes + 1> left;  // each node takes one and leaves two at most
  left[0] = whole;
  int count = 1;
  for (int nodes = 0; count > 0; ++nodes) {
    if (nodes == kMaxNodes) return false;
    const TimeSpan span = left[--count];
    OILSKIN_ASSERT(span.begin <= span.end);
    const double middle = span.middle();
    TimeSpan apart{1, 0};
    // A touch at an end of the span (at the start of the step, or at the end of the previous cut) is
    // approached at once by the directions of that end; those of the middle alone would only halve the span.
    if (improve(motion, middle, middle, span, &apart) || improve(motion, span.begin, middle, span, &apart) ||
        improve(motion, span.end, middle, span, &apart)) {
      continue;
    }
    if (apart.begin > apart.end) return false;
    OILSKIN_ASSERT(apart.begin <= middle && middle <= apart.end);
    if (apart.end < span.end) left[count++] = {apart.end, span.end};
    if (apart.begin > span.begin) left[count++] = {span.begin, apart.begin};
  }
  return true;
}

}  // namespace oilskin::ccd::detail
