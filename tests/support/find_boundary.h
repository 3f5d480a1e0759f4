/// The boundary terms of particles without a world.
#pragma once

#include "fluid/boundary/boundary.h"

namespace oilskin::test {

/// What `boundary` is found from, beside particles and surfaces.
struct BoundarySetting {
  double particle_mass, support_radius;  ///< [kg], [m]
  Vec3 down = Vec3::Zero();
};

/// Sorts the places by cells, as a fluid does. Returns which of the former places each of them is.
inline std::vector<std::uint32_t> find_boundary(fluid::Boundary& boundary, std::vector<Vec3>& x,
                                                Span<SurfaceMotion* const> surfaces,
                                                const BoundarySetting& setting, const Workers& workers) {
  fluid::Neighbours neighbours;
  std::vector<std::uint32_t> order = neighbours.cell_order(x, setting.support_radius, workers);
  std::vector<Vec3> sorted;
  for (const std::uint32_t i : order) sorted.push_back(x[i]);
  x = std::move(sorted);
  neighbours.search(x, workers);
  std::vector<MeshTopology> topologies;
  for (const SurfaceMotion* s : surfaces) topologies.emplace_back(s->triangles, s->x_t0.size());
  std::vector<const MeshTopology*> of_surfaces;
  for (const MeshTopology& topology : topologies) of_surfaces.push_back(&topology);
  fluid::TriangleCells cells;
  cells.find(x, surfaces, of_surfaces, {}, setting.support_radius, neighbours, workers);
  boundary.find({1e-3, 1e-3, setting.particle_mass, setting.support_radius, setting.down, x, surfaces,
                 of_surfaces, cells},
                workers);
  return order;
}

}  // namespace oilskin::test
