/// Cells that obstacles cut. Corners joined by uncut edges form parts. Each part is polygonised separately,
/// with all other corners outside, so the mesh can follow a sheet on both sides at any distance from the
/// nodes.
///
/// Two cells draw the same lines on their common face if no cut edge has both ends inside and in the same
/// part of one of its cells: then the inside corners of a face that share a part are joined along uncut edges
/// of the face, or lie on a diagonal, which the table separates. clear_joined_edges() establishes this.
#pragma once

#include "core/parallel.h"
#include "reconstruction/grid.h"
#include "reconstruction/marching_cubes.h"

namespace oilskin::reconstruction {

/// Signs of a block's 9³ nodes and cuts of their edges.
struct BlockRows {
  Rows inside;
  std::array<Rows, 3> cut{};
  bool has_cuts = false;

  void gather(const Grid& grid, std::uint32_t block);
  /// No change of sign and no cut edge with an end inside, so no surface.
  bool empty() const;
  /// Bit i: cell (i, j, k) may contain surface.
  std::uint8_t cells(int j, int k) const;
  std::uint8_t corners(int i, int j, int k) const;  ///< inside corners of a cell
  std::uint16_t cuts(int i, int j, int k) const;    ///< cut edges of a cell, bit e of cell_edges
};

/// Corners that are joined to `corner` by edges that are not cut.
std::uint8_t part_of(int corner, std::uint16_t cuts);

/// Calls f(mask) with the inside corners of each part that has inside corners.
template <class F>
void for_parts(std::uint8_t inside, std::uint16_t cuts, const F& f) {
  if (cuts == 0) {
    if (inside != 0 && inside != 0xff) f(inside);
    return;
  }
  for (unsigned left = inside; left != 0;) {
    const std::uint8_t part = part_of(__builtin_ctz(left), cuts);
    const auto mask = static_cast<std::uint8_t>(part & inside);
    if (mask != 0xff) f(mask);
    left &= ~unsigned(part);
  }
}

/// Calls f(i, j, k) for every cell of the block that may contain surface.
template <class F>
void for_surface_cells(const BlockRows& rows, const F& f) {
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (unsigned bits = rows.cells(j, k); bits != 0; bits &= bits - 1) f(__builtin_ctz(bits), j, k);
}

/// For each cut edge with both ends inside and in one part of a cell (at an obstacle's border): sets the end
/// that is nearer to an obstacle outside. Returns the number of nodes.
std::size_t clear_joined_edges(Grid& grid, const Workers& workers);

/// Sets the nodes outside that several threads found, in any order and with repetitions. Returns the number
/// of nodes that were inside.
std::size_t set_outside(Grid& grid, const std::vector<std::vector<NodeRef>>& found);

/// Corner c of cell (i, j, k).
inline NodeRef corner_node(const Grid& grid, std::uint32_t block, int i, int j, int k, int c) {
  return grid.node(block, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1));
}

/// The value of a node that is set outside [cells]: vertices stay off about half of the edges to it.
constexpr float cleared_value = 0.5f;

}  // namespace oilskin::reconstruction
