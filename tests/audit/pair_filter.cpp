#include "audit/pair_filter.h"

#include <algorithm>
#include <cmath>

namespace oilskin::audit {
namespace {

using Triple = std::array<Point, 3>;  // corners relative to the point

Point sub(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point mix(const Point& a, const Point& b, double t) {
  return {(1 - t) * a[0] + t * b[0], (1 - t) * a[1] + t * b[1], (1 - t) * a[2] + t * b[2]};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Triple relative(const std::array<Point, 4>& x) {
  return {sub(x[1], x[0]), sub(x[2], x[0]), sub(x[3], x[0])};
}

/// A lower bound of d·a for the unrounded difference a. Each product term carries at most four roundings
/// (difference, product, two sums), the magnitudes' sum as many, the subtraction one: 16 u is twice what is
/// needed. The constant covers underflow.
double min_dot(const Point& d, const Point& a) {
  const double x = d[0] * a[0], y = d[1] * a[1], z = d[2] * a[2];
  return x + y + z - (0x1p-49 * (std::abs(x) + std::abs(y) + std::abs(z)) + 1e-300);
}

/// How far along d (not normalised) the triangle certainly is.
double min_dot(const Point& d, const Triple& corners) {
  return std::min({min_dot(d, corners[0]), min_dot(d, corners[1]), min_dot(d, corners[2])});
}

bool axis_separates(const Triple& a, const Triple& b) {
  for (int k = 0; k < 3; ++k) {
    const double low = std::min({a[0][k], a[1][k], a[2][k], b[0][k], b[1][k], b[2][k]});
    const double high = std::max({a[0][k], a[1][k], a[2][k], b[0][k], b[1][k], b[2][k]});
    if (low > 0 || high < 0) return true;
  }
  return false;
}

/// The point of segment ab that is closest to the origin.
Point closest_on_segment(const Point& a, const Point& b) {
  const Point e = sub(b, a);
  const double length = dot(e, e);
  const double t = length > 0 ? std::clamp(-dot(a, e) / length, 0.0, 1.0) : 0;
  return {a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
}

/// Roughly the vector from the origin to the closest point of the triangle: the best direction to separate
/// them.
Point towards_triangle(const Triple& c) {
  const Point normal = cross(sub(c[1], c[0]), sub(c[2], c[0]));
  bool over_face = dot(normal, normal) > 0;
  for (int i = 0; i < 3 && over_face; ++i)
    over_face = dot(normal, cross(c[(i + 1) % 3], c[(i + 2) % 3])) >= 0;
  if (over_face) {
    const double height = dot(normal, c[0]) / dot(normal, normal);
    if (height != 0) return {height * normal[0], height * normal[1], height * normal[2]};
  }
  Point best{};
  double minimum = HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    const Point candidate = closest_on_segment(c[i], c[(i + 1) % 3]);
    const double distance = dot(candidate, candidate);
    if (distance < minimum) {
      minimum = distance;
      best = candidate;
    }
  }
  return best;
}

/// Is the triangle certainly on the side of d, from time t0 to time t1 (dyadic, so 1 − t is exact)? The
/// motion is linear and so are the bounds: the ends suffice. The factor keeps the interpolation's own
/// rounding on the safe side.
bool apart_along(const Point& d, const Triple& start, const Triple& end, double t0, double t1) {
  for (int i = 0; i < 3; ++i) {
    const double a = min_dot(d, start[i]), b = min_dot(d, end[i]);
    for (const double t : {t0, t1}) {
      const double x = (1 - t) * a, y = t * b;
      if (!(x + y > 0x1p-49 * (std::abs(x) + std::abs(y)))) return false;
    }
  }
  return true;
}

bool apart_between(const Triple& start, const Triple& end, double t0, double t1, int depth) {
  const double middle = 0.5 * (t0 + t1);
  const Triple at_middle{mix(start[0], end[0], middle), mix(start[1], end[1], middle),
                         mix(start[2], end[2], middle)};
  const Point d = towards_triangle(at_middle);
  if (apart_along(d, start, end, t0, t1)) return true;
  Point normal = cross(sub(at_middle[1], at_middle[0]), sub(at_middle[2], at_middle[0]));
  if (dot(normal, at_middle[0]) < 0) normal = {-normal[0], -normal[1], -normal[2]};
  if (apart_along(normal, start, end, t0, t1)) return true;
  if (depth == 0 || !apart_along(d, start, end, middle, middle)) return false;
  return apart_between(start, end, t0, middle, depth - 1) && apart_between(start, end, middle, t1, depth - 1);
}

}  // namespace

bool certainly_apart(const Pair& pair) {
  constexpr int kMaxDepth = 10;
  const Triple start = relative(pair.start), end = relative(pair.end);
  return axis_separates(start, end) || apart_between(start, end, 0, 1, kMaxDepth);
}

bool certainly_beyond(const Pair& pair, double delta) {
  const Triple end = relative(pair.end);
  const Point d = towards_triangle(end);
  // All of the triangle is at least min_dot/|d| away: it lies beyond a plane at that distance.
  const double length = std::sqrt(dot(d, d));
  return length > 1e-140 && min_dot(d, end) > delta * length * (1 + 1e-14);
}

}  // namespace oilskin::audit
