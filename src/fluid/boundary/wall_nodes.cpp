#include "fluid/boundary/wall_nodes.h"

#include <numeric>

#include "core/assert.h"

namespace oilskin::fluid {

void WallNodes::clear() {
  nodes_.clear();
  of_wall_.clear();
}

namespace {

constexpr std::uint32_t none = UINT32_MAX;

}  // namespace

void WallNodes::number(const std::vector<Wall>& walls, Span<SurfaceMotion* const> surfaces) {
  clear();
  number_.resize(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    if (number_[s].size() != surfaces[s]->x_t0.size()) number_[s].assign(surfaces[s]->x_t0.size(), none);
  of_wall_.reserve(walls.size());
  for (const Wall& wall : walls) {
    const Triangle& triangle = surfaces[wall.surface]->triangles[wall.triangle];
    std::array<std::uint32_t, 3> of_wall{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number_[wall.surface][triangle[k]];
      if (n == none) {
        n = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({wall.surface, triangle[k]});
      }
      of_wall[k] = n;
    }
    of_wall_.push_back(of_wall);
  }
  forget_numbers();
  list_corners();
}

void WallNodes::forget_numbers() {
  for (const Node& n : nodes_) number_[n.surface][n.node] = none;
}

void WallNodes::list_corners() {
  corners_begin_.assign(nodes_.size() + 1, 0);
  for (const auto& nodes : of_wall_)
    for (std::uint32_t n : nodes) ++corners_begin_[n + 1];
  std::partial_sum(corners_begin_.begin(), corners_begin_.end(), corners_begin_.begin());
  OILSKIN_ASSERT(corners_begin_.back() == 3 * of_wall_.size());
  corners_.resize(corners_begin_.back());
  std::vector<std::uint32_t> at(corners_begin_.begin(), corners_begin_.end() - 1);
  for (std::uint32_t w = 0; w < of_wall_.size(); ++w)
    for (std::uint8_t k = 0; k < 3; ++k) corners_[at[of_wall_[w][k]]++] = {w, k};
}

}  // namespace oilskin::fluid
