/// The places of a nozzle's particles within a layer.
#pragma once

#include <vector>

#include "oilskin/emitter.h"

namespace oilskin::fluid {

/// Points of the square lattice of `spacing` around the axis: the fewest that are `needed` or more, whole
/// orbits of the rotations about the axis that map the lattice to itself, nearest first (F.64). The axis
/// passes through a point, the middle of a cell or of an edge.
std::vector<Vec3> nozzle_sites(const DiscEmitter& emitter, double needed, double spacing);

}  // namespace oilskin::fluid
