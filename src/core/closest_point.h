/// Closest point of a closed triangle; robust for slivers, segments and points.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

struct ClosestPoint {
  std::array<double, 3>
      weights{};               ///< barycentric, each in [0, 1], Σ = 1; exactly 0 for nodes off the feature
  Vec3 offset = Vec3::Zero();  ///< p − closest point [m]
  double distance = 0;         ///< |offset| [m]
  std::uint8_t feature = 0;    ///< bit k: weight k ≠ 0. 1, 2, 4 vertices; 3, 5, 6 edges; 7 face
};

/// By regions ([Ericson2005] 5.1.5). For a degenerate triangle (|e1×e2|² ≤ 1e-14 · maxedge⁴) the closest
/// point of its three edges.
ClosestPoint closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace oilskin
