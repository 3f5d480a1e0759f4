/// Closest point of a closed triangle, robust for slivers, segments and points.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

struct ClosestPoint {
  std::array<double, 3> weights{};  ///< barycentric, each in [0, 1], Σ = 1; exact zeros off the feature
  Vec3 offset = Vec3::Zero();       ///< p − c [m]
  double distance = 0;              ///< |p − c| [m]
  std::uint8_t feature = 0;         ///< bit k: node k carries weight. 1, 2, 4 vertices; 3, 5, 6 edges; 7 face
};

/// Region method ([Ericson2005] 5.1.5) where the triangle is well shaped; where it is degenerate
/// (|e1×e2|² ≤ 1e-14 · maxedge⁴) the minimum over its three segments.
ClosestPoint closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace oilskin
