/// Where a particle may start: at least 2 δ from every surface, and in a volume that is filled not much
/// nearer to walls than a lattice beside them would.
#pragma once

#include "contact/surface_geometry.h"
#include "core/parallel.h"

namespace oilskin::world {

/// A surface at one moment. The tree of its geometry is fitted to it.
struct StandingSurface {
  Span<const Triangle> triangles;
  Span<const Vec3> x;               // of the nodes [m]
  Span<const double> inverse_mass;  // of the nodes [1/kg]
  double delta = 0;                 // δ [m]
  contact::SurfaceGeometry* geometry = nullptr;
  std::uint64_t still = 0;  // as SurfaceMotion::still
  bool solid = false;       // what it encloses is no place for particles
};

/// Per point: 1 where some triangle is nearer than 2 δ of its surface, or rounding cannot decide, and within
/// solids.
std::vector<std::uint8_t> find_blocked_points(Span<const StandingSurface> surfaces, Span<const Vec3> points,
                                              const Workers& workers);

/// Of the points of a lattice with this spacing, blocks those that are nearer than `distance` [m] to a
/// surface, but at cloth that has points on one side alone and can yield there. What is blocked already does
/// not count.
void block_crowded_points(Span<const StandingSurface> surfaces, double distance, double spacing,
                          Span<const Vec3> points, const Workers& workers,
                          std::vector<std::uint8_t>& blocked);

}  // namespace oilskin::world
