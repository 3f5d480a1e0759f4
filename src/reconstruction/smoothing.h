/// Smoothing that keeps the promise. If every vertex moves by less than its triangles have distance to spare,
/// no point of a triangle comes nearer than the gap: points move by means of what their corners move.
#pragma once

#include "reconstruction/obstacles.h"
#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

struct SmoothingReport {
  std::size_t held = 0;  ///< vertices put back because a triangle of theirs did not pass the final test
};

/// λ|μ smoothing [Taubin1995] (R.21), `iterations` pairs of steps. `obstacles` may be null: nothing to keep
/// away from. Vertices on the sides of `clip` stay.
SmoothingReport smooth(int iterations, const Obstacles* obstacles, double gap, double cell,
                       const std::optional<Box>& clip, RawMesh& mesh, const Workers& workers);

}  // namespace oilskin::reconstruction
