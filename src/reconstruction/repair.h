/// The repair loop: afterwards no triangle of the water is closer to an obstacle than the gap.
///
/// A patch lies in its cell and depends on the cell's corners only. If a triangle is not certified to be
/// farther away than the gap, one of the inside corners on which it depends is set outside, and the cells
/// around it are tested again. Nodes change from inside to outside only, so the loop ends. It ends only if
/// every triangle, with the floats that are returned, has passed.
#pragma once

#include "reconstruction/polygonise.h"
#include "reconstruction/triangle_distance.h"

namespace oilskin::reconstruction {

struct RepairReport {
  int rounds = 0;
  std::size_t nodes = 0;  ///< set outside
};

/// `gap` [m]. `only`: blocks to test first; empty: all.
RepairReport repair(const Obstacles& obstacles, double gap, Grid& grid, std::vector<std::uint32_t> only,
                    const Workers& workers);

/// Blocks with a cell of which one of these nodes is a corner, ascending.
std::vector<std::uint32_t> blocks_around(const Grid& grid, const std::vector<NodeRef>& changed);

}  // namespace oilskin::reconstruction
