/// Turns back the triangles that moves of the vertices have turned over.
#pragma once

#include "reconstruction/obstacles.h"
#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

/// What untangle() did.
struct Untangled {
  std::vector<std::uint32_t> triangles;  ///< those that may have changed
  std::size_t held = 0;                  ///< vertices whose moves were taken back
};

/// Where a triangle faces against the mean normal of its corners (R.39), moves its corners along the surface
/// towards the mean of their neighbours, by a cell at most, and by nothing on the sides of `clip`. Moves
/// after which a triangle fails the promise are taken back. `obstacles` may be null.
Untangled untangle(double cell, const std::optional<Box>& clip, const Obstacles* obstacles, double gap,
                   const SurfaceBlocks& blocks, RawMesh& mesh, const Workers& workers);

}  // namespace oilskin::reconstruction
