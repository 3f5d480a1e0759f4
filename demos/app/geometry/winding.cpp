#include "geometry/winding.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace oilskin::demo {
namespace {

constexpr std::int64_t steps = 4096;  // per cell, across the rays
static_assert(steps * Winding::resolution == 1);

struct Point {
  std::int64_t y, z;  // [1/steps cell]
};

/// Twice the signed area of (a, b, p).
std::int64_t area(const Point& a, const Point& b, const Point& p) {
  return (b.y - a.y) * (p.z - a.z) - (b.z - a.z) * (p.y - a.y);
}

/// The side of p to the line from a to b, ±1. On the line, that of p moved by ε in y and ε² in z: then no ray
/// passes through an edge, and the two triangles at an edge agree.
int side(const Point& a, const Point& b, const Point& p) {
  const std::int64_t twice = area(a, b, p);
  if (twice != 0) return twice > 0 ? 1 : -1;
  if (b.z != a.z) return b.z < a.z ? 1 : -1;
  return b.y > a.y ? 1 : -1;
}

std::int32_t row_from(std::int64_t least) {
  return static_cast<std::int32_t>(std::floor(double(least) / double(steps)));
}

}  // namespace

Winding::Winding(Span<const Float3> positions, Span<const Triangle> triangles, double cell) {
  for (const Triangle& t : triangles) add({positions[t[0]], positions[t[1]], positions[t[2]]}, cell);
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.k, a.j, a.x, a.enters) < std::tie(b.k, b.j, b.x, b.enters);
  });
}

void Winding::add(const std::array<Float3, 3>& corner, double cell) {
  Point p[3];
  double x[3];
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = {std::llround(double(corner[c][1]) / cell * double(steps)),
            std::llround(double(corner[c][2]) / cell * double(steps))};
    x[c] = double(corner[c][0]) / cell;
  }
  const std::int64_t whole = area(p[0], p[1], p[2]);
  if (whole == 0) return;  // no ray passes through it
  const int facing = whole > 0 ? 1 : -1;
  const auto [y_min, y_max] = std::minmax({p[0].y, p[1].y, p[2].y});
  const auto [z_min, z_max] = std::minmax({p[0].z, p[1].z, p[2].z});
  for (std::int32_t k = row_from(z_min); k <= row_from(z_max) + 1; ++k)
    for (std::int32_t j = row_from(y_min); j <= row_from(y_max) + 1; ++j) {
      const Point ray = {j * steps, k * steps};
      if (side(p[0], p[1], ray) != facing || side(p[1], p[2], ray) != facing ||
          side(p[2], p[0], ray) != facing)
        continue;
      double at = 0;
      for (std::size_t c = 0; c < 3; ++c)
        at += double(area(p[(c + 1) % 3], p[(c + 2) % 3], ray)) / double(whole) * x[c];
      // The normal's x has the sign of `facing`: a ray along x enters where it is negative.
      crossings_.push_back({k, j, at, -facing});
    }
}

int Winding::at(int i, int j, int k) const {
  auto it = std::lower_bound(
      crossings_.begin(), crossings_.end(), std::make_tuple(k, j),
      [](const Crossing& c, const std::tuple<int, int>& row) { return std::tie(c.k, c.j) < row; });
  int winding = 0;
  for (; it != crossings_.end() && it->k == k && it->j == j && it->x < i; ++it) winding += it->enters;
  return winding;
}

}  // namespace oilskin::demo
