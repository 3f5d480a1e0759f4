/// The volume of water in a cell of the grid.
#pragma once

#include "oilskin/types.h"
#include "reconstruction/marching_cubes.h"

namespace oilskin::reconstruction {

/// The volume [cells³] of the part of a cell with the inside corners `part`. `at`: the vertices on the cell's
/// edges, relative to its first corner [cells]; those of edges without a vertex of this part are not read.
double part_volume(std::uint8_t part, const std::array<Vec3, 12>& at);

}  // namespace oilskin::reconstruction
