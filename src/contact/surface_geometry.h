/// What contact derives from a surface and keeps from step to step.
#pragma once

#include "core/mesh_topology.h"
#include "oilskin/surface_motion.h"
#include "proximity/surface_tree.h"

namespace oilskin::contact {

/// Results never depend on it: a lost one is made again. Not to be shared by two surfaces.
struct SurfaceGeometry {
  std::uint64_t id = 0;  // of the surface that `topology` was made for; 0 = none
  MeshTopology topology;
  proximity::SurfaceTree tree;     // fits itself to the triangles that it is given
  std::uint64_t fitted_still = 0;  // SurfaceMotion::still of what fit() fitted the tree to
  Hierarchy hierarchy = Hierarchy::flat;

  /// Analyses the mesh of a surface whose id it has not seen: a changed mesh has a new id.
  void analyse(const SurfaceMotion& surface) {
    if (id == surface.id) return;
    id = 0;
    topology = MeshTopology(surface.triangles, surface.x_t1.size());
    id = surface.id;
  }

  /// Fits the tree to the swept triangles; a still surface of one number, once.
  void fit(Span<const Triangle> triangles, Span<const Vec3> x_t0, Span<const Vec3> x_t1, std::uint64_t still,
           const Workers& workers) {
    if (still != 0 && fitted_still == still) return;
    fitted_still = 0;
    tree.update(triangles, x_t0, x_t1, workers, hierarchy);
    fitted_still = still;
  }
  void fit(const SurfaceMotion& s, const Workers& workers) {
    fit(s.triangles, s.x_t0, s.x_t1, s.still, workers);
  }

  /// What refits and searches the tree from now on.
  void use(Hierarchy h) {
    if (h != hierarchy) fitted_still = 0;
    hierarchy = h;
  }
};

}  // namespace oilskin::contact
