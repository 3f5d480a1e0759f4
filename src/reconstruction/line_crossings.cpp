#include "reconstruction/line_crossings.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::reconstruction {

LineCrossings::LineCrossings(const std::vector<std::array<float, 3>>& positions,
                             const std::vector<Triangle>& triangles, int axis)
    : positions_(positions), triangles_(triangles) {
  OILSKIN_ASSERT(axis >= 0 && axis < 3);
  for (std::size_t k = 0; k < 3; ++k) axes_[k] = (static_cast<std::size_t>(axis) + 1 + k) % 3;
}

void LineCrossings::add(std::uint32_t triangle) {
  if (numbers_.size() % group == 0) groups_.emplace_back();
  numbers_.push_back(triangle);
  Group& g = groups_.back();
  for (const std::uint32_t v : triangles_[triangle]) {
    const std::array<float, 3>& p = positions_[v];
    for (std::size_t k = 0; k < 2; ++k) {
      g.low[k] = std::min(g.low[k], p[axes_[k]]);
      g.high[k] = std::max(g.high[k], p[axes_[k]]);
    }
    g.top = std::max(g.top, p[axes_[2]]);
  }
}

void LineCrossings::add_all() {
  numbers_.reserve(triangles_.size());
  groups_.reserve(triangles_.size() / group + 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) add(t);
}

int LineCrossings::beyond(const Vec3& at) const {
  const Point x = {at[Eigen::Index(axes_[0])], at[Eigen::Index(axes_[1])], at[Eigen::Index(axes_[2])]};
  int sum = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].may_be_beyond(x)) continue;
    const std::size_t end = std::min(numbers_.size(), (g + 1) * group);
    for (std::size_t k = g * group; k < end; ++k) sum += beyond(x, triangles_[numbers_[k]]);
  }
  return sum;
}

/// Is x left of an edge, as seen against the axis? `area`: twice that of its triangle with x. Both triangles
/// of an edge compute the same number, but for the sign, so that a line passes through exactly one of them.
/// Vertices of the mesh lie on lines of the grid, and so may x: on an edge it is where x + (ε, ε²) is.
bool LineCrossings::is_left_of(std::uint32_t from, std::uint32_t to, const Point& x, double& area) const {
  if (from > to) {
    const bool is_left = is_left_of(to, from, x, area);
    area = -area;
    return !is_left;
  }
  const std::array<float, 3>&a = positions_[from], &b = positions_[to];
  const double ax = double(a[axes_[0]]), ay = double(a[axes_[1]]);
  const double dx = double(b[axes_[0]]) - ax, dy = double(b[axes_[1]]) - ay;
  area = dx * (x[1] - ay) - dy * (x[0] - ax);
  if (area != 0) return area > 0;
  return dy != 0 ? dy < 0 : dx > 0;
}

/// 1: the triangle is beyond x and its normal points along the axis, −1: against it, 0: it is not beyond x.
int LineCrossings::beyond(const Point& x, const Triangle& t) const {
  std::array<double, 3> area{};  // opposite to the corners
  int left = 0;
  for (std::size_t k = 0; k < 3; ++k) left += is_left_of(t[(k + 1) % 3], t[(k + 2) % 3], x, area[k]);
  if (left != 0 && left != 3) return 0;
  double height = 0, sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    height += area[k] * (double(positions_[t[k]][axes_[2]]) - x[2]);
    sum += area[k];
  }
  // With normals against the axis the areas are negative.
  const int sign = left == 3 ? 1 : -1;
  return sign * height > 0 && sum != 0 ? sign : 0;
}

}  // namespace oilskin::reconstruction
