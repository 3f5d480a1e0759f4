/// Do two triangles intersect, and how far are they apart? Another algorithm than the library's: signs of
/// determinants, exact where doubles do not decide, and distances in long doubles.
#pragma once

#include "oilskin/reconstruction.h"

namespace oilskin::test {

using Corners3 = std::array<Vec3, 3>;

/// Exact for closed triangles, of which one at least has an area.
bool triangles_meet(const Corners3& t, const Corners3& c);

/// Nearest vertex–face and edge–edge distance [m], to about 1e-15 of the size; 0 where they intersect.
double triangle_distance(const Corners3& t, const Corners3& c);

struct PairAudit {
  std::size_t meeting = 0;
  double minimum = std::numeric_limits<double>::infinity();  ///< of the pairs whose boxes are within `reach`
  std::size_t pairs = 0;
};

/// All pairs of the mesh and an obstacle whose boxes are within `reach` [m].
PairAudit audit_pairs(const WaterMesh& mesh, const ObstacleMesh& obstacle, double reach);

}  // namespace oilskin::test
