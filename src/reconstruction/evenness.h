/// How evenly the particles of sparse water lie.
#pragma once

#include "reconstruction/cube_lattice.h"
#include "reconstruction/particle_blocks.h"

namespace oilskin::reconstruction {

/// Per cube `excess`, where the water is sparse and even. Less, between 1 and 0 times that: its density comes
/// near to that at rest, or the distances of particles from their nearest neighbours differ as those at
/// random places do, or the grid can show them apart. 0 where there is no particle. `spacing` in cells.
Cubes evenness(const ParticleBlocks& particles, double spacing, const Cubes& excess, const Grid& grid,
               const CubeLattice& lattice, const Workers& workers);

}  // namespace oilskin::reconstruction
