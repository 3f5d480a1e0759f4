#include "fluid/boundary/wall_visibility.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::fluid {

WallVisibility::WallVisibility(const BoundaryInput& input, const Vec3& x, Span<const NearTriangle> near)
    : x_(x), surfaces_(input.surfaces), near_(near), tolerance_(1e-6 * input.support_radius) {
  for (std::size_t k = 0; k < near.size(); ++k) {
    test_.emplace_back(*surfaces_[near[k].surface], near[k].triangle);
    own_side_.push_back(test_[k].side(x));
    by_distance_.push_back(k);
  }
  std::sort(by_distance_.begin(), by_distance_.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(near_[a].closest.distance, a) < std::make_pair(near_[b].closest.distance, b);
  });
}

bool WallVisibility::is_hidden(std::size_t k) const {
  OILSKIN_ASSERT(k < near_.size());
  if (lies_on_earlier(k)) return true;
  for (std::size_t other : by_distance_) {
    if (other == k) return false;  // all that follow are farther away
    if (is_blocked_by(k, other)) return true;
  }
  return false;
}

bool WallVisibility::adjoin(std::size_t a, std::size_t b) const {
  if (near_[a].surface != near_[b].surface) return false;
  const std::vector<Triangle>& triangles = surfaces_[near_[a].surface]->triangles;
  const Triangle &s = triangles[near_[a].triangle], &t = triangles[near_[b].triangle];
  return std::any_of(t.begin(), t.end(),
                     [&](std::uint32_t n) { return std::find(s.begin(), s.end(), n) != s.end(); });
}

bool WallVisibility::have_same_closest_point(std::size_t a, std::size_t b) const {
  return (near_[a].closest.offset - near_[b].closest.offset).norm() <= tolerance_;
}

bool WallVisibility::lies_on_earlier(std::size_t k) const {
  for (std::size_t other = 0; other < k; ++other)
    if (!adjoin(k, other) && have_same_closest_point(k, other) && test_[other].is_parallel_to(test_[k]))
      return true;
  return false;
}

bool WallVisibility::is_blocked_by(std::size_t k, std::size_t other) const {
  const SightTest& test = test_[other];
  if (test.normal_length() == 0 || adjoin(k, other) || have_same_closest_point(k, other)) return false;
  const Vec3 at = x_ - near_[k].closest.offset;
  const double side = test.side(at);
  const bool in_its_plane =
      std::abs(side) <= tolerance_ * test.normal_length() && test.is_parallel_to(test_[k]);
  return !in_its_plane && test.blocks(x_, at, own_side_[other], side);
}

}  // namespace oilskin::fluid
