/// A still surface as contact and fluid see it, without a world.
#pragma once

#include "support/static_mesh.h"

namespace oilskin::test {

/// `inverse_mass` [1/kg] of every node; 0 = prescribed.
inline SurfaceMotion surface_of(const StaticMesh& mesh, double inverse_mass = 0, std::uint64_t id = 1) {
  SurfaceMotion m;
  m.id = id;
  m.triangles = mesh.triangles;
  m.x_t0 = m.x_t1 = mesh.nodes;
  m.thickness = 0.001;
  m.delta = 1e-6;
  m.velocity.assign(mesh.nodes.size(), Vec3::Zero());
  m.inverse_mass.assign(mesh.nodes.size(), inverse_mass);
  m.holdable.assign(mesh.nodes.size(), 0);
  m.impulse.assign(mesh.nodes.size(), Vec3::Zero());
  m.moved.assign(mesh.nodes.size(), 0);
  return m;
}

}  // namespace oilskin::test
