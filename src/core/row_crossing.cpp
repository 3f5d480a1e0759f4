#include "core/row_crossing.h"

#include <algorithm>
#include <utility>

namespace oilskin {

namespace {

/// Side of the edge a→b, seen along x, on which the row (y, z) passes: +1 or −1, 0 for an edge along x.
/// Evaluated in one order of a and b, so that it is antisymmetric bit for bit. A row through the edge is
/// shifted symbolically by (ε, ε²), the same for all edges [Edelsbrunner1990].
int side(const Vec3& a, const Vec3& b, double y, double z) {
  const bool swap = std::make_pair(b[1], b[2]) < std::make_pair(a[1], a[2]);
  const Vec3 &p = swap ? b : a, &q = swap ? a : b;
  const double dy = q[1] - p[1], dz = q[2] - p[2];
  double s = dy * (z - p[2]) - dz * (y - p[1]);
  if (s == 0) s = dz != 0 ? -dz : dy;
  const int sign = (s > 0) - (s < 0);
  return swap ? -sign : sign;
}

bool is_beside(double a, double b, double c, double x) {
  return x < std::min({a, b, c}) || x > std::max({a, b, c});
}

}  // namespace

int row_sign(const Vec3& a, const Vec3& b, const Vec3& c, double y, double z) {
  const int s = side(a, b, y, z);
  return s != 0 && side(b, c, y, z) == s && side(c, a, y, z) == s ? s : 0;
}

double row_x(const Vec3& a, const Vec3& b, const Vec3& c, double y, double z) {
  const Vec3 normal = (b - a).cross(c - a);
  const double low = std::min({a[0], b[0], c[0]}), high = std::max({a[0], b[0], c[0]});
  const double x = a[0] - (normal[1] * (y - a[1]) + normal[2] * (z - a[2])) / normal[0];
  return x >= low ? std::min(x, high) : low;  // low also for NaN
}

int crossing_number(Span<const Triangle> triangles, Span<const Vec3> nodes, const Vec3& x) {
  int number = 0;
  for (const Triangle& t : triangles) {
    const Vec3 &a = nodes[t[0]], &b = nodes[t[1]], &c = nodes[t[2]];
    if (is_beside(a[1], b[1], c[1], x[1]) || is_beside(a[2], b[2], c[2], x[2])) continue;
    const int s = row_sign(a, b, c, x[1], x[2]);
    if (s != 0 && row_x(a, b, c, x[1], x[2]) > x[0]) number += s;
  }
  return number;
}

}  // namespace oilskin
