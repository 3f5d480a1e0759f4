#include "core/segment_triangle.h"

#include <algorithm>
#include <cmath>

namespace oilskin {

namespace {

/// For p and q in the plane of the triangle: no line along an edge or along the segment separates the two.
bool touches_in_plane(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& c, const Vec3& normal) {
  Eigen::Index drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const Eigen::Index a = (drop + 1) % 3, b = (drop + 2) % 3;
  // The sign is the side of the line from → to on which x lies; 0 on it.
  const auto turn = [a, b](const Vec3& from, const Vec3& to, const Vec3& x) {
    return (to[a] - from[a]) * (x[b] - from[b]) - (to[b] - from[b]) * (x[a] - from[a]);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &u = c[k], &v = c[(k + 1) % 3], &w = c[(k + 2) % 3];
    const double inner = turn(u, v, w), at_p = turn(u, v, p), at_q = turn(u, v, q);
    if (std::max(at_p, at_q) < std::min(inner, 0.0) || std::min(at_p, at_q) > std::max(inner, 0.0))
      return false;
  }
  const double s0 = turn(p, q, c[0]), s1 = turn(p, q, c[1]), s2 = turn(p, q, c[2]);
  return !(std::min({s0, s1, s2}) > 0 || std::max({s0, s1, s2}) < 0);
}

}  // namespace

bool segment_touches(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& corner, const Triangle& nodes,
                     const Vec3& normal, double side_p, double side_q) {
  if ((side_p > 0 && side_q > 0) || (side_p < 0 && side_q < 0)) return false;
  if (side_p == 0 && side_q == 0) return touches_in_plane(p, q, corner, normal);
  // Error of a volume, relative to the product of the three lengths.
  constexpr double volume_error = 1e-14;
  const Vec3 along = q - p;
  const std::array<Vec3, 3> r = {corner[0] - p, corner[1] - p, corner[2] - p};
  const double length2 = along.squaredNorm(),
               l2[3] = {r[0].squaredNorm(), r[1].squaredNorm(), r[2].squaredNorm()};
  bool left = true, right = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const bool reversed = nodes[k] > nodes[next];
    const std::size_t from = reversed ? next : k, to = reversed ? k : next;
    const double volume = along.dot(r[from].cross(r[to]));
    // Within rounding of the edge: touched. Otherwise a line through a vertex could pass all its edges by
    // their rounding errors.
    if (volume * volume <= volume_error * volume_error * length2 * l2[from] * l2[to]) continue;
    const double sign = reversed ? -volume : volume;
    left &= sign > 0;
    right &= sign < 0;
  }
  return left || right;
}

}  // namespace oilskin
