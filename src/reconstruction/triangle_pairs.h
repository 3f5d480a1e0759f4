/// Pairs of triangles of the mesh and of obstacles that are close to each other.
#pragma once

#include <functional>

#include "oilskin/surface_motion.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// The corners as stored, in float precision for any compiler.
inline Corners stored_corners(const std::vector<std::array<float, 3>>& positions, const Triangle& t) {
  Corners c;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& p = positions[t[k]];
    c[k] = stored(Vec3(p[0], p[1], p[2]), Storage::float32);
  }
  return c;
}

/// Calls f(t, candidates) from several threads, for each triangle t of the mesh (of `only`, if not null) with
/// triangles of obstacles whose boxes are within `reach` [m] of its box.
void for_near_pairs(const std::vector<std::array<float, 3>>& positions,
                    const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>* only,
                    const Obstacles& obstacles, double reach, const Workers& workers,
                    const std::function<void(std::uint32_t, Span<const std::uint32_t>)>& f);

}  // namespace oilskin::reconstruction
