/// The water of particles in the cubes of the grid.
#pragma once

#include "reconstruction/cube_lattice.h"
#include "reconstruction/particle_blocks.h"
#include "reconstruction/water.h"

namespace oilskin::reconstruction {

/// Each particle fills a cube of edge `spacing` [cells], of 4 cells at most, so that the result does not jump
/// where a particle passes from one cube of the lattice to the next. Drops do not count, others as `least` at
/// least. Cubes are those of the grid's cells, or of its nodes, which are half a cell lower. [cells³]
Cubes water_in_cubes(const ParticleBlocks& particles, const Water& water, double spacing, const Grid& grid,
                     const CubeLattice& lattice, const Workers& workers, double least = 0,
                     bool of_nodes = false);

}  // namespace oilskin::reconstruction
