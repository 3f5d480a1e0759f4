/// Cells that an obstacle cuts. Corners joined by edges that are not cut form parts; each part is polygonised
/// by itself, as if all other corners were outside. So the water's surface may follow a sheet on both sides,
/// however near the grid's nodes are to it.
///
/// Two cells at a face draw the same lines there, if no cut edge has both of its ends inside and in the same
/// part of one of its cells: then the inside corners of a face that share a part are joined by edges of the
/// face that are not cut, or lie on a diagonal, which is parted anyway. clear_joined_edges() establishes
/// that.
#pragma once

#include "core/parallel.h"
#include "reconstruction/grid.h"
#include "reconstruction/marching_cubes.h"

namespace oilskin::reconstruction {

/// Signs and cuts of a block's 9³ nodes.
struct BlockRows {
  Rows inside;
  std::array<Rows, 3> cut{};
  bool has_cuts = false;

  void gather(const Grid& grid, std::uint32_t block);
  /// Neither a change of sign nor a cut edge with an end inside: no surface here.
  bool empty() const;
  /// Bit i: cell (i, j, k) may hold surface.
  std::uint8_t cells(int j, int k) const;
  std::uint8_t corners(int i, int j, int k) const;  ///< inside corners of a cell
  std::uint16_t cuts(int i, int j, int k) const;    ///< cut edges of a cell, bit e of cell_edges
};

/// Corners that are joined to `corner` by edges that are not cut.
std::uint8_t part_of(int corner, std::uint16_t cuts);

/// f(mask) for the inside corners of every part that has some.
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

/// f(i, j, k) for every cell of the block that may hold surface.
template <class F>
void for_surface_cells(const BlockRows& rows, const F& f) {
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (unsigned bits = rows.cells(j, k); bits != 0; bits &= bits - 1) f(__builtin_ctz(bits), j, k);
}

/// Sets outside the end nearer to an obstacle of every cut edge whose ends are both inside and in one part of
/// a cell (an obstacle's border lies there). Returns how many nodes.
std::size_t clear_joined_edges(Grid& grid, const Workers& workers);

/// Sets nodes outside that were asked for by several threads, in any order and repeatedly; those that are
/// outside already stay. Returns how many.
std::size_t set_outside(Grid& grid, const std::vector<std::vector<NodeRef>>& found);

/// Corner c of cell (i, j, k).
inline NodeRef corner_node(const Grid& grid, std::uint32_t block, int i, int j, int k, int c) {
  return grid.node(block, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1));
}

/// The value that a cleared node gets [cells]: its neighbours' vertices keep off half of their edges.
constexpr float cleared_value = 0.5f;

}  // namespace oilskin::reconstruction
