/// The nodes of the walls' triangles, numbered in the order of surfaces and nodes.
#pragma once

#include <atomic>
#include <memory>

#include "core/sort_by_key.h"
#include "fluid/boundary/wall_geometry.h"

namespace oilskin::fluid {

class WallNodes {
 public:
  struct Node {
    std::uint32_t surface = 0, node = 0;
    bool operator<(const Node& o) const { return surface != o.surface ? surface < o.surface : node < o.node; }
  };
  struct Corner {
    std::uint32_t wall;
    std::uint8_t corner;
  };

  void number(const std::vector<Wall>& walls, Span<SurfaceMotion* const> surfaces, const Workers& workers);
  void clear();

  std::size_t size() const { return nodes_.size(); }
  const Node& operator[](std::size_t n) const { return nodes_[n]; }
  /// Numbers of the three nodes of a wall.
  const std::array<std::uint32_t, 3>& of_wall(std::size_t wall) const { return of_wall_[wall]; }
  /// Corners of walls that are node n.
  Span<const Corner> corners_of(std::size_t n) const { return corners_.of(n); }

 private:
  /// Of the nodes of a surface, for several threads.
  class Numbers {
   public:
    /// Of so many nodes, none of which has a number if that was so before.
    void resize(std::size_t nodes);
    std::atomic<std::uint32_t>& operator[](std::size_t node) { return number_[node]; }

   private:
    std::unique_ptr<std::atomic<std::uint32_t>[]> number_;
    std::size_t size_ = 0;
  };

  void find_nodes(const std::vector<Wall>& walls, Span<SurfaceMotion* const> surfaces,
                  const Workers& workers);

  std::vector<Node> nodes_;
  std::vector<std::array<std::uint32_t, 3>> of_wall_;
  KeyedLists<Corner> corners_;
  std::vector<Numbers> number_;  // per surface; kept for its memory alone
  bool has_numbers_ = false;     // after an exception
};

}  // namespace oilskin::fluid
