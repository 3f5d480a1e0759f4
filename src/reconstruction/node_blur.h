/// Means and largest values over the nodes around each node of the grid.
#pragma once

#include "reconstruction/cube_lattice.h"

namespace oilskin::reconstruction {

/// A value per node, per block of the lattice.
using NodeValues = std::vector<std::array<float, nodes>>;

/// The part of the cell around each node that is inside: between 0 and 1 next to the surface.
NodeValues inside_parts(const Grid& grid, const CubeLattice& lattice, const Workers& workers);

/// The share of the space around each node that is inside: the mean of the parts with the weights of a
/// Gaussian with this standard deviation [cells], in each direction, ½ or more. Beyond the lattice blocks are
/// inside if they are solid.
NodeValues inside_shares(NodeValues parts, double deviation, const Grid& grid, const CubeLattice& lattice,
                         const Workers& workers);

/// The largest of the values in the cube of nodes that reaches so far to each side.
NodeValues largest_around(NodeValues values, int reach, const Grid& grid, const CubeLattice& lattice,
                          const Workers& workers);

}  // namespace oilskin::reconstruction
