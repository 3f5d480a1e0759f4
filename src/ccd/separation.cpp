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

/// The motion is linear, so d·A is linear in time, and bounds at the ends bound it in between.
struct LinearBound {
  double t0, t1;

  double at_time(double t) const { return (1 - t) * t0 + t * t1; }
};

/// The time closest to `outer` up to which `bound` is positive, starting from `inner`, where it is. The
/// crossing is rounded, so it is tested, and moved inwards until the test succeeds.
double last_positive(const LinearBound& bound, double inner, double outer) {
  if (bound.at_time(outer) > 0) return outer;
  constexpr double steps[] = {0x1p-48, 0x1p-40, 0x1p-20, 0x1p-4};
  const double crossing = bound.t0 / (bound.t0 - bound.t1);
  double t = std::max(std::min(crossing, std::max(inner, outer)), std::min(inner, outer));
  for (const double step : steps) {
    if (bound.at_time(t) > 0) return t;
    t += (inner - t) * step;
  }
  return bound.at_time(t) > 0 ? t : inner;
}

/// Sets `part` to the times of `span` around `at` at which all corners are certainly on the side of the point
/// to which d points. False if there are none.
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

/// The triangle relative to the point at one time, rounded; used to choose directions.
std::array<Direction, 3> corners_at(const RelativeMotion& motion, double t) {
  std::array<Direction, 3> corner;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) corner[i][k] = (1 - t) * motion.t0[i][k] + t * motion.t1[i][k];
  }
  return corner;
}

/// Visits directions that may separate a point from a triangle: for each feature that may be closest. Stops
/// when `visit(d)` returns true. Each edge has two: the perpendicular in the triangle's plane (best for
/// points in the plane), and the perpendicular from the point (for segments and slivers, whose normal is
/// inaccurate).
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
  // Dot products with an axis have the rounding error of the difference only, so they decide the smallest
  // gaps.
  for (int k = 0; k < 3; ++k) {
    Direction axis{};
    axis[k] = 1;
    if (visit(axis)) return;
  }
}

/// Scaled by a power of two so that the largest component is close to 1: products of directions neither
/// overflow nor underflow. Scaling down may round components below 2⁻¹⁰²² times the largest, which
/// lower_bound() covers.
RelativeMotion scaled_to_unity(const RelativeMotion& motion) {
  double max_component = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      max_component = std::max({max_component, std::abs(motion.t0[i][k]), std::abs(motion.t1[i][k])});
    }
  }
  if ((max_component > 0x1p-40 && max_component < 0x1p40) || max_component == 0 ||
      !std::isfinite(max_component))
    return motion;
  const int exponent = -std::ilogb(max_component);
  RelativeMotion scaled;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      scaled.t0[i][k] = std::ldexp(motion.t0[i][k], exponent);
      scaled.t1[i][k] = std::ldexp(motion.t1[i][k], exponent);
    }
  }
  return scaled;
}

/// Tries the directions for the triangle at time `guess`. `best` becomes the longest part of `span` around
/// `at` that one of them separates. True if it is the whole span.
bool improve(const RelativeMotion& motion, double guess, double at, const TimeSpan& span, TimeSpan* best) {
  const std::array<Direction, 3> corner = corners_at(motion, guess);
  const Direction sum = {corner[0][0] + corner[1][0] + corner[2][0],
                         corner[0][1] + corner[1][1] + corner[2][1],
                         corner[0][2] + corner[1][2] + corner[2][2]};
  bool covers_span = false;
  for_each_candidate(corner, [&](Direction d) {
    // Any direction is valid. Pointing it at the triangle's centre saves the test of the other sign.
    if (dot(d, sum) < 0) d = {-d[0], -d[1], -d[2]};
    TimeSpan part;
    if (!certify(motion, d, at, span, &part)) return false;
    covers_span = part.begin <= span.begin && part.end >= span.end;
    if (covers_span || part.width() > best->width()) *best = part;
    return covers_span;
  });
  return covers_span;
}

}  // namespace

/// (T.12). Let S = Σ|d_k A_k| with the exact A. Roundings of a term of the computed dot product, in units of
/// u S:
///
///   A itself, the product, two sums                                   4
///   the bound's subtraction from the sum                              1
///   `at_time`: 1 − t, the product, the sum (of terms up to S)         3
///                                                                     8
///
/// The computed S is smaller than S by at most four roundings, a term of second order like the products of
/// roundings: 10 u S covers all. Each end includes 3 u S for the interpolation, and `at_time` weights both
/// ends as it weights their errors. The additive term covers underflow: a product errs by 2⁻¹⁰⁷⁵, and so does
/// a component of A that scaled_to_unity() scales down, times |d| < 100 there.
double lower_bound(const std::array<double, 3>& d, const double* a) {
  constexpr double underflow = 1e-300;
  const double x = d[0] * a[0], y = d[1] * a[1], z = d[2] * a[2];
  const double sum_of_magnitudes = std::abs(x) + std::abs(y) + std::abs(z);
  return (x + y + z) - (10 * unit_roundoff * sum_of_magnitudes + underflow);
}

bool certainly_apart(const RelativeMotion& original, const TimeSpan& all) {
  // Enough for triangles that turn while they slide past. Beyond that, exact arithmetic is faster.
  constexpr int max_nodes = 4;
  const RelativeMotion motion = scaled_to_unity(original);
  std::array<TimeSpan, max_nodes + 1> left;  // each node removes one and adds at most two
  left[0] = all;
  int count = 1;
  for (int nodes = 0; count > 0; ++nodes) {
    if (nodes == max_nodes) return false;
    const TimeSpan span = left[--count];
    OILSKIN_ASSERT(span.begin <= span.end);
    const double middle = span.middle();
    TimeSpan apart{1, 0};
    // The directions at an end of the span find a touch at that end (the start of the step, or the end of the
    // previous part) at once; those of the middle would only halve the span.
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
