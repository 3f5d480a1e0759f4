/// The loop that ends with no triangle of the water nearer to an obstacle than the gap.
///
/// A patch lies in its cell and depends on the cell's corners alone. Where a triangle cannot be shown to be
/// farther away than the gap, one of the inside corners it hangs on is set outside, and the cells around are
/// looked at again. Nodes only ever go outside, so it ends; and it ends only when every triangle, with the
/// floats that will be written, has passed.
#pragma once

#include "reconstruction/polygonise.h"
#include "reconstruction/triangle_distance.h"

namespace oilskin::reconstruction {

struct RepairReport {
  int rounds = 0;
  std::size_t nodes = 0;
};

/// `gap` [m]. `only`: blocks to begin with; empty: all.
RepairReport repair(const Obstacles& obstacles, double gap, Grid& grid, std::vector<std::uint32_t> only,
                    const Workers& workers);

/// Blocks that have a cell with one of these nodes as a corner, ascending.
std::vector<std::uint32_t> blocks_around(const Grid& grid, const std::vector<NodeRef>& changed);

}  // namespace oilskin::reconstruction
