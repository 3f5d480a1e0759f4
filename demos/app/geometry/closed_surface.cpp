#include "geometry/closed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace oilskin::demo {
namespace {

constexpr int bins_per_side = 64;
constexpr int across = 0, along = 2, up = 1;  // axes; rays go up

}  // namespace

ClosedSurface::ClosedSurface(const SurfaceMotion& cloth) : cloth_(cloth) {
  for (const Vec3& x : cloth.x_t1) box_.add(x);
  bins_.resize(bins_per_side * bins_per_side);
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    Box box;
    for (const std::uint32_t i : cloth.triangles[t]) box.add(cloth.x_t1[i]);
    for (int j = bin(box.min[along], along); j <= bin(box.max[along], along); ++j)
      for (int i = bin(box.min[across], across); i <= bin(box.max[across], across); ++i)
        bins_[j * bins_per_side + i].push_back(static_cast<std::uint32_t>(t));
  }
}

int ClosedSurface::bin(double x, int axis) const {
  const double width = box_.max[axis] - box_.min[axis];
  const double part = width > 0 ? (x - box_.min[axis]) / width : 0;
  return std::clamp(static_cast<int>(part * bins_per_side), 0, bins_per_side - 1);
}

bool ClosedSurface::closed() const {
  std::map<std::array<std::uint32_t, 2>, int> balance;
  for (const Triangle& t : cloth_.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = t[k], j = t[(k + 1) % 3];
      if (i != j) balance[{std::min(i, j), std::max(i, j)}] += i < j ? 1 : -1;
    }
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

/// Contribution of the edge to the number of turns about the upward line through p: it counts where it
/// crosses the half plane on one side of that line. Always computed from the smaller index to the larger, so
/// that the faces on both sides of an edge agree, whatever rounding does.
int ClosedSurface::half_turn(std::uint32_t i, std::uint32_t j, const Vec3& p) const {
  if (i > j) return -half_turn(j, i, p);
  const Vec3 a = cloth_.x_t1[i] - p, b = cloth_.x_t1[j] - p;
  const bool from = a[across] > 0, to = b[across] > 0;
  if (from == to) return 0;
  const double side = a[along] * b[across] - a[across] * b[along];
  if (to) return side > 0 ? 1 : 0;
  return side < 0 ? -1 : 0;
}

/// For a face that the upward line through p crosses.
bool ClosedSurface::below(const Vec3& p, const Triangle& t) const {
  const Vec3 a = cloth_.x_t1[t[0]] - p, b = cloth_.x_t1[t[1]] - p, c = cloth_.x_t1[t[2]] - p;
  const Vec3 normal = (b - a).cross(c - a);
  return a.dot(normal) * normal[up] > 0;
}

int ClosedSurface::winding_number(const Vec3& p) const {
  for (const int axis : {across, along})
    if (p[axis] < box_.min[axis] || p[axis] > box_.max[axis]) return 0;
  int sum = 0;
  for (const std::uint32_t f : bins_[bin(p[along], along) * bins_per_side + bin(p[across], across)]) {
    const Triangle& t = cloth_.triangles[f];
    const int turns = half_turn(t[0], t[1], p) + half_turn(t[1], t[2], p) + half_turn(t[2], t[0], p);
    if (turns != 0 && below(p, t)) sum += turns;
  }
  return sum;
}

double ClosedSurface::volume() const {
  double sum = 0;
  const Vec3 middle = 0.5 * (box_.min + box_.max);
  for (const Triangle& t : cloth_.triangles) {
    const Vec3 a = cloth_.x_t1[t[0]] - middle, b = cloth_.x_t1[t[1]] - middle, c = cloth_.x_t1[t[2]] - middle;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

}  // namespace oilskin::demo
