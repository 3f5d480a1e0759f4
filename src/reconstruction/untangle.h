/// Turns back the triangles that moves of the vertices have turned over.
#pragma once

#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

/// Where a triangle faces against the mean normal of its corners (R.39), moves its corners along the surface
/// towards the mean of their neighbours, by a cell at most, and by nothing on the sides of `clip`. Triangles
/// may fail the promise afterwards.
void untangle(double cell, const std::optional<Box>& clip, const SurfaceBlocks& blocks, RawMesh& mesh,
              const Workers& workers);

}  // namespace oilskin::reconstruction
