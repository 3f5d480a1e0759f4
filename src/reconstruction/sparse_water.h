/// Sparse water: where particles lie at random with much less than the density of water, their field fills
/// the space between them.
#pragma once

#include "reconstruction/cube_lattice.h"
#include "reconstruction/field.h"
#include "reconstruction/particle_blocks.h"
#include "reconstruction/water.h"

namespace oilskin::reconstruction {

/// Raises the values of the grid where they enclose most of the space and much more than the water (R.41), so
/// that there is air between the particles before the mesh is made. `spacing` and `band`, in which distances
/// from obstacles are known, in cells: nodes nearer to obstacles than band − 1, where films are, keep their
/// values.
void open_sparse_water(const ParticleBlocks& particles, const Water& water, const FieldParameters& field,
                       double spacing, double band, const Workers& workers, Grid& grid);

/// Sets nodes inside that alone are outside, away from obstacles: bubbles that the grid does not resolve. The
/// fit may move the surface past them.
void fill_single_nodes(const Workers& workers, Grid& grid);

}  // namespace oilskin::reconstruction
