/// Dynamic rigid bodies: velocities of their points, and what impulses change (docs/theory/contact.md, "Rigid
/// bodies").
#pragma once

#include "oilskin/report.h"
#include "oilskin/surface_motion.h"

namespace oilskin {

/// Of the point at `arm` from the centre of mass.
inline Vec3 velocity_at(const BodyMotion& body, const Vec3& arm) {
  return body.velocity + body.angular_velocity.cross(arm);
}

/// An impulse [N s] at the point at `arm` from the centre of mass.
inline void push_body(BodyMotion& body, const Vec3& arm, const Vec3& impulse) {
  const Vec3 moment = arm.cross(impulse);
  body.velocity += body.inverse_mass.cwiseProduct(impulse);
  body.angular_velocity += body.inverse_inertia * moment;
  body.impulse += impulse;
  body.angular_impulse += moment;
}

/// An impulse [N s] at the centre of mass and a moment [N m s].
inline void push_and_turn(BodyMotion& body, const Vec3& impulse, const Vec3& moment) {
  push_body(body, Vec3::Zero(), impulse);
  body.angular_velocity += body.inverse_inertia * moment;
  body.angular_impulse += moment;
}

/// An impulse on a node: of a body, of a sheet, or the reaction of a prescribed node.
inline void push_node(SurfaceMotion& s, std::uint32_t node, const Vec3& impulse) {
  s.add_impulse(node, impulse);
  s.velocity[node] += s.inverse_mass[node] * impulse;
  if (s.body) push_body(*s.body, s.x_t0[node] - s.body->center_t0, impulse);
}

/// The part of an impulse that the body takes; the rest is a reaction of what locks its axes.
inline Vec3 along_free_axes(const BodyMotion& body, const Vec3& impulse) {
  return (body.inverse_mass.array() > 0).select(impulse, Vec3::Zero());
}

/// Books an impulse on a node of a body.
inline void record_on_body(ContactReport& report, const BodyMotion& body, const Vec3& impulse) {
  const Vec3 taken = along_free_axes(body, impulse);
  report.impulse_on_bodies += taken;
  report.impulse_on_prescribed += impulse - taken;
}

/// Whether friction must know what the host does with loads: dry friction, and any friction of a body.
inline bool friction_follows_host(const SurfaceMotion& s) {
  return s.has_dry_friction() ||
         (s.body && (s.slip_on(false).model != SlipModel::free || s.slip_on(true).model != SlipModel::free));
}

/// [a]×: [a]× b = a × b.
Eigen::Matrix3d cross_matrix(const Vec3& a);

/// The matrix A of Δv = A J at the point at `arm` [1/kg] (C.37).
Eigen::Matrix3d inverse_mass_at(const BodyMotion& body, const Vec3& arm);

/// The largest eigenvalue of the symmetric `a` across the unit vector n.
double largest_across(const Eigen::Matrix3d& a, const Vec3& n);

/// Gives the nodes of a surface with a body the velocities of its motion.
void set_node_velocities(SurfaceMotion& surface);

/// The inertia about the centre of mass [kg m²]; 0 about axes that the host locks.
Eigen::Matrix3d inertia_of(const BodyMotion& body);
/// Whether the host locks no axis.
bool is_free(const BodyMotion& body);

/// What the caller of contact fills in of a body for a step of dt [s]. `before`: the body as the last step
/// left it, if it was one; a new surface starts where it ends.
void start_body(SurfaceMotion& surface, const std::optional<BodyMotion>& before, bool is_new, double dt);

/// Refuses numbers that are not finite or beyond 1e15, and masses and inertias that make no sense.
Status check_body(const SurfaceMotion& surface);

}  // namespace oilskin
