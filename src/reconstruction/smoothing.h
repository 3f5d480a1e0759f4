/// Smoothing that keeps the promise. A point of a triangle moves by a convex combination of its corners'
/// moves. So if each vertex moves by less than the spare distance of its triangles, no point comes closer
/// than the gap.
#pragma once

#include "reconstruction/obstacles.h"
#include "reconstruction/polygonise.h"

namespace oilskin::reconstruction {

struct SmoothingReport {
  std::size_t held = 0;  ///< vertices put back since one of their triangles failed the final test
};

/// λ|μ smoothing [Taubin1995] (R.21) with `iterations` pairs of steps. `obstacles` may be null. Vertices on
/// the sides of `clip` do not move.
SmoothingReport smooth(int iterations, const Obstacles* obstacles, double gap, double cell,
                       const std::optional<Box>& clip, RawMesh& mesh, const Workers& workers);

/// Moves the vertices of triangles that fail the promise off obstacles, or back to `start`, where all pass,
/// until all pass. Returns the number of vertices. `only`: the triangles that may fail; null: all. Vertices
/// end within `clip`, and not farther from `start` than they were.
std::size_t put_back(const Obstacles& obstacles, double gap, const std::optional<Box>& clip,
                     const std::vector<std::uint32_t>* only, const std::vector<std::array<float, 3>>& start,
                     RawMesh& mesh, const Workers& workers);

}  // namespace oilskin::reconstruction
