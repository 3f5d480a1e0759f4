/// The triangles within the support radius H of each particle.
#pragma once

#include <vector>

#include "core/closest_point.h"
#include "core/mesh_topology.h"
#include "core/parallel.h"
#include "fluid/neighbours.h"
#include "fluid/triangle_list.h"
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
  Span<const TriangleList> near;               ///< per surface: at least those within H; empty = all
};

/// A triangle within H of a particle.
struct NearTriangle {
  std::uint32_t particle = 0;
  std::uint32_t surface = 0, triangle = 0;
  ClosestPoint closest;
};

/// Lists by particle; each in the order of surfaces and triangles. The memory is kept from search to search.
class NearTriangles {
 public:
  /// The triangles whose plane is nearer than `plane_reach` [m], of the particles with a mark (of all if
  /// there are no marks). Leaves out duplicate triangles.
  void find(const BoundaryInput& input, double plane_reach, const std::vector<std::uint8_t>& marks,
            const Workers& workers);

  Span<const NearTriangle> of(std::size_t particle) const {
    return {list_.data() + begin_[particle], begin_[particle + 1] - begin_[particle]};
  }

 private:
  void sort_by_particle(std::size_t particles, std::size_t chunks);

  std::vector<std::uint32_t> begin_;  // per particle, and one more
  std::vector<NearTriangle> list_;    // may be longer than begin_ says
  std::vector<std::vector<NearTriangle>> found_;
  std::vector<std::uint32_t> next_;
};

}  // namespace oilskin::fluid
