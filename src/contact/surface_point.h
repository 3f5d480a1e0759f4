/// The point of a surface that a contact names: of a sheet between nodes, or of a rigid body.
#pragma once

#include "core/body_motion.h"
#include "oilskin/contact.h"

namespace oilskin::contact {

/// From the centre of mass of the surface's body to the point, at the start.
inline Vec3 arm_of(const SurfaceMotion& s, const Contact& c) {
  Vec3 arm = -s.body->center_t0;
  for (int k = 0; k < 3; ++k) arm += c.weights[k] * s.x_t0[c.nodes[k]];
  return arm;
}

/// The nodes of a body have its velocities only when the sweeps are done.
inline Vec3 velocity_of(const SurfaceMotion& s, const Contact& c) {
  if (s.body) return velocity_at(*s.body, arm_of(s, c));
  Vec3 v = Vec3::Zero();
  for (int k = 0; k < 3; ++k) v += c.weights[k] * s.velocity[c.nodes[k]];
  return v;
}

/// Σ_c b_c²/m_c of the nodes (C.10); 0 for a body.
inline double inverse_mass_of_nodes(const SurfaceMotion& s, const Contact& c) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += c.weights[k] * c.weights[k] * s.inverse_mass[c.nodes[k]];
  return sum;
}

/// Of nodes or body, for an impulse along the unit vector n [1/kg].
inline double inverse_mass_along(const SurfaceMotion& s, const Contact& c, const Vec3& n) {
  if (!s.body) return inverse_mass_of_nodes(s, c);
  return std::max(0.0, n.dot(inverse_mass_at(*s.body, arm_of(s, c)) * n));
}

/// (C.11). The impulse on a prescribed node is the reaction of its support.
inline void push_point(SurfaceMotion& s, const Contact& c, const Vec3& impulse) {
  if (s.body) push_body(*s.body, arm_of(s, c), impulse);
  for (int k = 0; k < 3; ++k) {
    if (c.weights[k] == 0) continue;
    const std::uint32_t node = c.nodes[k];
    const Vec3 node_impulse = c.weights[k] * impulse;
    s.velocity[node] += s.inverse_mass[node] * node_impulse;
    s.add_impulse(node, node_impulse);
  }
}

}  // namespace oilskin::contact
