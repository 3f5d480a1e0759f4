#include "geometry/pool.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace oilskin::demo {
namespace {

struct Column {
  double volume = 0, area = 0;
};

/// Volume between a triangle and the level y above it. `plan` is its area seen along `up`, h its
/// corners' heights in order. The part of a linear slope that is cut off by a level is a triangle similar in
/// both directions, so its area goes with the square and its volume with the cube of the depth at its corner.
Column column_over(double plan, const std::array<double, 3>& h, double y) {
  if (y <= h[0]) return {};
  if (y < h[1]) {
    const double area = plan * (y - h[0]) * (y - h[0]) / ((h[1] - h[0]) * (h[2] - h[0]));
    return {area * (y - h[0]) / 3, area};
  }
  const double full = plan * (y - (h[0] + h[1] + h[2]) / 3);  // dry parts count as negative
  if (y >= h[2]) return {full, plan};
  const double dry = plan * (h[2] - y) * (h[2] - y) / ((h[2] - h[0]) * (h[2] - h[1]));
  return {full + dry * (h[2] - y) / 3, plan - dry};
}

class Basin {
 public:
  Basin(const SurfaceMotion& cloth, const Vec3& up) : cloth_(cloth), up_(up) {}

  Column filled_to(double y) const {
    Column sum;
    for (const Triangle& t : cloth_.triangles) {
      const Vec3 &a = cloth_.x_t1[t[0]], &b = cloth_.x_t1[t[1]], &c = cloth_.x_t1[t[2]];
      std::array<double, 3> h = {a.dot(up_), b.dot(up_), c.dot(up_)};
      std::sort(h.begin(), h.end());
      const Column part = column_over(0.5 * std::abs((b - a).cross(c - a).dot(up_)), h, y);
      sum.volume += part.volume;
      sum.area += part.area;
    }
    return sum;
  }

  double lowest() const {
    double minimum = std::numeric_limits<double>::infinity();
    for (const Vec3& x : cloth_.x_t1) minimum = std::min(minimum, x.dot(up_));
    return minimum;
  }

  /// Of the nodes on edges of one triangle only: from there on the basin runs over.
  double lowest_rim() const {
    std::map<std::array<std::uint32_t, 2>, int> edges;
    for (const Triangle& t : cloth_.triangles)
      for (int k = 0; k < 3; ++k) ++edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
    double minimum = std::numeric_limits<double>::infinity();
    for (const auto& [edge, count] : edges)
      if (count == 1)
        for (const std::uint32_t i : edge) minimum = std::min(minimum, cloth_.x_t1[i].dot(up_));
    return minimum;
  }

 private:
  const SurfaceMotion& cloth_;
  const Vec3 up_;
};

}  // namespace

PoolSurface pool_surface(const SurfaceMotion& cloth, const Vec3& up, double volume) {
  const Basin basin(cloth, up);
  PoolSurface surface;
  double low = basin.lowest(), high = basin.lowest_rim();
  surface.in_rim = high < std::numeric_limits<double>::infinity() && basin.filled_to(high).volume >= volume;
  if (!surface.in_rim) return surface;
  for (int i = 0; i < 60; ++i) {  // to the last bits of a double
    const double middle = 0.5 * (low + high);
    (basin.filled_to(middle).volume < volume ? low : high) = middle;
  }
  surface.height = high;
  surface.area = basin.filled_to(high).area;
  return surface;
}

double level_in_middle(const SurfaceMotion& cloth, Span<const Vec3> positions, const Vec3& up,
                       double radius) {
  const auto lower = [&](const Vec3& a, const Vec3& b) { return a.dot(up) < b.dot(up); };
  const auto deepest = std::min_element(cloth.x_t1.begin(), cloth.x_t1.end(), lower);
  std::vector<double> heights;
  for (const Vec3& x : positions) {
    const Vec3 displacement = x - *deepest;
    if ((displacement - up * displacement.dot(up)).norm() < radius) heights.push_back(x.dot(up));
  }
  if (heights.empty()) return std::numeric_limits<double>::infinity();
  const auto at = heights.begin() + static_cast<std::ptrdiff_t>(0.95 * double(heights.size() - 1));
  std::nth_element(heights.begin(), at, heights.end());
  return *at;
}

double fraction_above(Span<const Vec3> positions, const Vec3& up, double height) {
  if (positions.size() == 0) return 0;
  std::size_t count = 0;
  for (const Vec3& x : positions) count += x.dot(up) > height ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(positions.size());
}

double kinetic_energy_per_mass(Span<const Vec3> velocities, Span<const float> ratios) {
  double sum = 0;
  for (std::size_t i = 0; i < velocities.size(); ++i)
    sum += 0.5 * (ratios.empty() ? 1 : static_cast<double>(ratios[i])) * velocities[i].squaredNorm();
  return sum;
}

double rms_speed_within(Span<const Vec3> positions, Span<const Vec3> velocities, const Box& within) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!within.contains(positions[i])) continue;
    sum += velocities[i].squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : std::numeric_limits<double>::infinity();
}

}  // namespace oilskin::demo
