/// Turns back the triangles that moves of the vertices have turned over.
#pragma once

#include "reconstruction/obstacles.h"
#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

/// Where a triangle faces against the mean normal of its corners (R.39), moves its corners along the surface
/// towards the mean of their neighbours, by a cell at most, and by nothing on the sides of `clip`. Moves
/// after which a triangle fails the promise are taken back. `obstacles` may be null. Returns the triangles
/// that may have changed.
std::vector<std::uint32_t> untangle(double cell, const std::optional<Box>& clip, const Obstacles* obstacles,
                                    double gap, const SurfaceBlocks& blocks, RawMesh& mesh,
                                    const Workers& workers);

}  // namespace oilskin::reconstruction
