/// Where a particle may start: at least 2 δ from every surface.
#pragma once

#include "contact/surface_geometry.h"
#include "core/parallel.h"

namespace oilskin::world {

/// A surface at one moment. The tree of its geometry is fitted to it.
struct StandingSurface {
  Span<const Triangle> triangles;
  Span<const Vec3> x;  // of the nodes [m]
  double delta = 0;    // δ [m]
  contact::SurfaceGeometry* geometry = nullptr;
  std::uint64_t still = 0;  // as SurfaceMotion::still
};

/// Per point: 1 where some triangle is nearer than 2 δ of its surface, or rounding cannot decide.
std::vector<std::uint8_t> find_blocked_points(Span<const StandingSurface> surfaces, Span<const Vec3> points,
                                              const Workers& workers);

}  // namespace oilskin::world
