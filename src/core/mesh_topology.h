/// Adjacency of a triangle mesh: equal triangles, triangles at a node, the border. It depends on indices
/// alone, so one analysis holds for as long as the triangles do.
#pragma once

#include <array>
#include <vector>

#include "core/assert.h"
#include "oilskin/types.h"

namespace oilskin {

class MeshTopology {
 public:
  MeshTopology() = default;
  /// Indices must be < node_count (asserted). Degenerate and duplicate triangles are allowed.
  MeshTopology(Span<const Triangle> triangles, std::size_t node_count);

  std::size_t triangle_count() const { return first_equal_.size(); }
  std::size_t node_count() const { return begin_.empty() ? 0 : begin_.size() - 1; }

  /// The first triangle with the same three nodes, in whatever order: the triangle itself where there is no
  /// earlier one.
  std::uint32_t first_equal(std::uint32_t triangle) const {
    OILSKIN_ASSERT(triangle < first_equal_.size());
    return first_equal_[triangle];
  }
  /// Does an earlier triangle have the same three nodes?
  bool is_duplicate(std::uint32_t triangle) const { return first_equal(triangle) != triangle; }

  /// Does the triangle have a node on a border edge? An edge is at the border unless exactly two triangles
  /// share it; duplicates do not count.
  bool is_at_border(std::uint32_t triangle) const {
    OILSKIN_ASSERT(triangle < at_border_.size());
    return at_border_[triangle] != 0;
  }

  static constexpr std::uint32_t none = UINT32_MAX;
  /// The other triangle at the edge from the triangle's corner k to the next; none unless exactly two
  /// triangles share the edge.
  std::uint32_t neighbour(std::uint32_t triangle, std::size_t k) const {
    OILSKIN_ASSERT(triangle < neighbour_.size() && k < 3);
    return neighbour_[triangle][k];
  }
  /// Do the triangle and neighbour(triangle, k) run through their edge in opposite directions, as the
  /// triangles of an oriented sheet do?
  bool is_oriented_like(std::uint32_t triangle, std::size_t k) const {
    OILSKIN_ASSERT(triangle < neighbour_.size() && k < 3);
    return (turned_[triangle] >> k & 1) == 0;
  }
  /// The least triangle that is reached over edges with neighbours: the name of the connected part.
  std::uint32_t part(std::uint32_t triangle) const {
    OILSKIN_ASSERT(triangle < part_.size());
    return part_[triangle];
  }

  /// Is the triangle's part a closed oriented surface: has each edge two triangles that run through it in
  /// opposite directions?
  bool is_closed(std::uint32_t triangle) const {
    OILSKIN_ASSERT(triangle < part_.size());
    return is_closed_[part_[triangle]] != 0;
  }

  /// The triangles that have the node, ascending. A triangle that names the node twice is listed twice.
  Span<const std::uint32_t> triangles_of(std::uint32_t node) const {
    OILSKIN_ASSERT(node < node_count());
    return {triangle_.data() + begin_[node], begin_[node + 1] - begin_[node]};
  }

 private:
  void collect_triangles_of_nodes(Span<const Triangle> triangles);
  void connect(Span<const Triangle> triangles);
  void join(std::uint32_t a, std::size_t edge_a, std::uint32_t b, std::size_t edge_b, bool same_direction);
  void find_parts();
  bool is_closed_at(std::uint32_t triangle) const;

  std::vector<std::uint32_t> first_equal_;  // per triangle
  std::vector<std::uint32_t> begin_;        // per node, into triangle_; one more than there are nodes
  std::vector<std::uint32_t> triangle_;
  std::vector<std::uint8_t> at_border_;  // per triangle
  std::vector<std::array<std::uint32_t, 3>> neighbour_;
  std::vector<std::uint8_t> turned_;  // per triangle, a bit per edge
  std::vector<std::uint32_t> part_;
  std::vector<std::uint8_t> is_closed_;  // of the part that the triangle names
};

}  // namespace oilskin
