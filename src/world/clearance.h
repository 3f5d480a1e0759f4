/// Where a particle may start: at least 2 δ from every surface.
#pragma once

#include "core/parallel.h"
#include "oilskin/surface_motion.h"
#include "proximity/surface_tree.h"

namespace oilskin::world {

/// A surface at one moment. The tree is fitted to it.
struct StandingSurface {
  Span<const Triangle> triangles;
  Span<const Vec3> x;  // of the nodes [m]
  double delta = 0;    // δ [m]
  proximity::SurfaceTree* tree = nullptr;
};

/// Per point: 1 where some triangle is nearer than 2 δ of its surface, or rounding cannot decide.
std::vector<std::uint8_t> find_blocked_points(Span<const StandingSurface> surfaces, Span<const Vec3> points,
                                              const Workers& workers);

}  // namespace oilskin::world
