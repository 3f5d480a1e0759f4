/// The triangles within the support radius H of each particle.
#pragma once

#include <vector>

#include "core/closest_point.h"
#include "core/mesh_topology.h"
#include "core/parallel.h"
#include "fluid/neighbours.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

/// What the boundary terms of an interval are computed from.
struct BoundaryInput {
  double dt = 0;              ///< [s]
  double particle_mass = 0;   ///< [kg]
  double support_radius = 0;  ///< H [m]
  Vec3 down = Vec3::Zero();   ///< direction of gravity, or zero
  Span<const Vec3> x;         ///< positions [m] that `neighbours` was searched for
  const Neighbours& neighbours;
  Span<SurfaceMotion* const> surfaces;         ///< walls at x_t0, which move to x_t1 within dt
  Span<const MeshTopology* const> topologies;  ///< of the surfaces, in their order
};

/// A triangle within H of a particle.
struct NearTriangle {
  std::uint32_t particle = 0;
  std::uint32_t surface = 0, triangle = 0;
  ClosestPoint closest;
};

/// Lists by particle; each in the order of surfaces and triangles.
struct NearTriangles {
  std::vector<std::uint32_t> begin;  ///< per particle, and one more
  std::vector<NearTriangle> list;

  Span<const NearTriangle> of(std::size_t particle) const {
    return {list.data() + begin[particle], begin[particle + 1] - begin[particle]};
  }
};

/// The triangles whose plane is nearer than `plane_reach` [m], of the particles with a mark (of all if there
/// are no marks). Leaves out duplicate triangles.
NearTriangles find_near_triangles(const BoundaryInput& input, double plane_reach,
                                  const std::vector<std::uint8_t>& marks, const Workers& workers);

}  // namespace oilskin::fluid
