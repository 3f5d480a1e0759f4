/// Pairs of a mesh's triangles with obstacles' triangles near them.
#pragma once

#include <functional>

#include "oilskin/surface_motion.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// The corners as they are stored: floats, whatever the compiler makes of conversions.
inline Corners stored_corners(const std::vector<std::array<float, 3>>& positions, const Triangle& t) {
  Corners c;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& p = positions[t[k]];
    c[k] = stored(Vec3(p[0], p[1], p[2]), Storage::float32);
  }
  return c;
}

/// f(t, candidates) for each of the mesh's triangles (of `only`, if that is not null) that have obstacles'
/// triangles whose boxes are within `reach` [m] of theirs, from several threads.
void for_near_pairs(const std::vector<std::array<float, 3>>& positions,
                    const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>* only,
                    const Obstacles& obstacles, double reach, const Workers& workers,
                    const std::function<void(std::uint32_t, Span<const std::uint32_t>)>& f);

}  // namespace oilskin::reconstruction
