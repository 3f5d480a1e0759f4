#include "fluid/boundary/view_samples.h"

#include <algorithm>
#include <cmath>

#include "fluid/kernels.h"

namespace oilskin::fluid {

/// Centres of equal parts of the sphere, on a spiral with the golden angle.
struct ViewSamples::Directions {
  std::array<float, directions> x, y, z;
  Directions() {
    const double golden_angle = pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < directions; ++k) {
      const double height = (2 * static_cast<double>(k) + 1) / static_cast<double>(directions) - 1;
      const double radius = std::sqrt(1 - height * height), angle = golden_angle * static_cast<double>(k);
      x[k] = static_cast<float>(radius * std::cos(angle));
      y[k] = static_cast<float>(radius * std::sin(angle));
      z[k] = static_cast<float>(height);
    }
  }
};

void ViewSamples::clear() {
  triangles_ = 0;
  distance_.fill(1);
  seen_.fill(-1);
}

/// At least the directions in a cone: those between its lowest and its highest, which follow each other.
ViewSamples::Range ViewSamples::directions_in(const Eigen::Vector3f& axis, float cosine) {
  if (cosine < 0) return {0, directions};
  const float c = axis.z(), s = std::sqrt(std::max(0.0f, 1 - c * c)),
              sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const float lowest = c > -cosine ? c * cosine - s * sine : -1,
              highest = c < cosine ? c * cosine + s * sine : 1;
  constexpr float slack = 1e-3f, half = 0.5f * static_cast<float>(directions);  // rounding takes 1e-6
  const auto number_at = [](float height) {
    return static_cast<std::size_t>(std::clamp(half * (1 + height), 0.0f, 2 * half));
  };
  return {number_at(lowest - slack), std::min(directions, number_at(highest + slack) + 1)};
}

void ViewSamples::add(const WallPlane& plane, const std::array<Eigen::Vector3f, 3>& side,
                      const Eigen::Vector3f& axis, float cosine) {
  static const Directions d;
  const auto number = static_cast<std::int32_t>(triangles_++);
  if (plane.offset == 0) return;  // edge-on
  const Range range = directions_in(axis, cosine);
  const Eigen::Vector3f n = plane.normal / plane.offset, &a = side[0], &b = side[1], &c = side[2];
  // Without branches, so that the compiler takes several directions at once.
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const float x = d.x[k], y = d.y[k], z = d.z[k];
    const float away = 1 / (n.x() * x + n.y() * y + n.z() * z);
    const float inside =
        std::min(std::min(a.x() * x + a.y() * y + a.z() * z, b.x() * x + b.y() * y + b.z() * z),
                 c.x() * x + c.y() * y + c.z() * z);
    const bool is_seen = (inside >= 0) & (away > 0) & (away < distance_[k]);
    distance_[k] = is_seen ? away : distance_[k];
    seen_[k] = is_seen ? number : seen_[k];
  }
}

const std::vector<float>& ViewSamples::masses() {
  masses_.assign(triangles_, 0.0f);
  constexpr auto part = static_cast<float>(2 * pi / static_cast<double>(directions));
  for (std::size_t k = 0; k < directions; ++k)
    if (seen_[k] >= 0) masses_[static_cast<std::size_t>(seen_[k])] += part * mass_beyond(distance_[k]);
  return masses_;
}

}  // namespace oilskin::fluid
