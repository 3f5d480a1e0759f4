/// The nodes of the walls' triangles, numbered in the order in which the walls name them.
#pragma once

#include "fluid/boundary/wall_geometry.h"

namespace oilskin::fluid {

class WallNodes {
 public:
  struct Node {
    std::uint32_t surface = 0, node = 0;
  };
  struct Corner {
    std::uint32_t wall;
    std::uint8_t corner;
  };

  void number(const std::vector<Wall>& walls, Span<SurfaceMotion* const> surfaces);
  void clear();

  std::size_t size() const { return nodes_.size(); }
  const Node& operator[](std::size_t n) const { return nodes_[n]; }
  /// Numbers of the three nodes of a wall.
  const std::array<std::uint32_t, 3>& of_wall(std::size_t wall) const { return of_wall_[wall]; }
  /// Corners of walls that are node n.
  Span<const Corner> corners_of(std::size_t n) const {
    return {corners_.data() + corners_begin_[n], corners_begin_[n + 1] - corners_begin_[n]};
  }

 private:
  void list_corners();
  void forget_numbers();

  std::vector<Node> nodes_;
  std::vector<std::array<std::uint32_t, 3>> of_wall_;
  std::vector<std::uint32_t> corners_begin_;
  std::vector<Corner> corners_;
  std::vector<std::vector<std::uint32_t>> number_;  // per surface and node; kept for its memory alone
};

}  // namespace oilskin::fluid
