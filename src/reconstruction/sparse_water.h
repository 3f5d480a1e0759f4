/// Sparse water: where particles lie with much less than the density of water, their field fills the space
/// between them.
#pragma once

#include "reconstruction/even_water.h"
#include "reconstruction/field.h"
#include "reconstruction/water.h"

namespace oilskin::reconstruction {

/// Makes the grid enclose less where it encloses much more than the water, before the mesh is made: water in
/// which particles lie evenly gets narrower (R.42), and between other particles that fill most of the space
/// there is air (R.41). `spacing` and `band`, in which distances from obstacles are known, in cells: nodes
/// nearer to obstacles than band − 1, where films are, keep their values.
DrawnIn open_sparse_water(const ParticleBlocks& particles, const Water& water, const FieldParameters& field,
                          double spacing, double band, const Workers& workers, Grid& grid);

/// Sets nodes inside that alone are outside, away from obstacles: bubbles that the grid does not resolve. The
/// fit may move the surface past them.
void fill_single_nodes(const Workers& workers, Grid& grid);

}  // namespace oilskin::reconstruction
