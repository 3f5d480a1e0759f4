#include "contact/constraints.h"

#include <algorithm>
#include <cmath>

#include "contact/contacts.h"
#include "contact/friction.h"
#include "contact/squeeze.h"
#include "contact/surface_point.h"
#include "contact/turn.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

// Of the particle's liquid.
void record_load(Context& context, const Contact& c, const Vec3& impulse) {
  std::vector<Vec3>& load = (*context.loads)[context.liquid_of(c.particle)][c.surface];
  if (load.empty()) load.assign(context.surfaces[c.surface]->x_t0.size(), Vec3::Zero());
  for (std::size_t k = 0; k < 3; ++k) load[c.nodes[k]] += c.weights[k] * impulse;
}

// (C.11)
void apply_impulse(Context& context, const Contact& c, const Vec3& impulse, bool moves_particle) {
  OILSKIN_ASSERT(impulse.allFinite());
  const Vec3 dv = context.particles->inverse_mass[c.particle] * impulse;
  context.particles->velocity[c.particle] += dv;
  if (moves_particle)
    context.set_particle_end(c.particle, context.particles->x_t1[c.particle] + context.dt * dv);
  if (context.particles->inverse_mass[c.particle] == 0) context.report->impulse_on_prescribed += impulse;
  push_point(*context.surfaces[c.surface], c, -impulse);
  if (context.loads) record_load(context, c, -impulse);
}

// Inelastic stop (C.12): v_n ≥ 0 with an accumulated impulse J_n ≥ 0. [Huber2013] Eq. 2 with the inverse
// effective mass of (C.10).
void stop(Context& context, ContactConstraint& constraint, bool moves_particle) {
  const double vn = relative_velocity(context, constraint.contact).dot(constraint.contact.normal);
  const double impulse = std::max(constraint.normal_impulse - vn / constraint.k, 0.0);
  const double change = impulse - constraint.normal_impulse;
  if (change == 0) return;
  OILSKIN_ASSERT(impulse >= 0);
  constraint.normal_impulse = impulse;
  apply_impulse(context, constraint.contact, change * constraint.contact.normal, moves_particle);
}

// Keeps the speed of what approaches because a smooth sheet turns (C.35): the kinetic energy that the stop
// takes is given back along the sheet; a body that resists less along the sheet gets no more than that. It
// comes before the stop, as it needs the approach.
void turn(Context& context, const ContactConstraint& constraint, bool moves_particle) {
  const Vec3 &n = constraint.contact.normal, v = relative_velocity(context, constraint.contact);
  const double vn = v.dot(n);
  const Vec3 vt = v - vn * n;
  const double speed = vt.norm(), kept = speed_to_turn(constraint, vn, speed);
  if (kept == 0) return;
  const double gain = kept * kept / (speed * (std::hypot(speed, kept) + speed));  // of vt, relative
  apply_impulse(context, constraint.contact, gain / std::max(constraint.k, constraint.k_tangent) * vt,
                moves_particle);
}

// Spring repulsion of [Bridson2002] with its cap (C.15); without it, as in [Huber2013] Eq. 4, it is unstable.
void spring(Context& context, ContactConstraint& constraint) {
  if (!(constraint.overlap > 0)) return;
  const double vn = relative_velocity(context, constraint.contact).dot(constraint.contact.normal);
  const double cap = (0.1 * constraint.overlap / context.dt - vn) / constraint.k;
  const double spring_force_impulse = context.settings->stiffness * constraint.overlap * context.dt;
  const double impulse = std::min(constraint.spring_impulse + std::max(cap, 0.0), spring_force_impulse);
  const double change = impulse - constraint.spring_impulse;
  if (change == 0) return;
  OILSKIN_ASSERT(impulse >= 0 && impulse <= spring_force_impulse);
  constraint.spring_impulse = impulse;
  apply_impulse(context, constraint.contact, change * constraint.contact.normal, true);
}

// Split repulsion (C.14): displaces without adding velocity. The multiplier is accumulated, so that many
// particles on one node remove a tenth of the overlap together, not a tenth each.
void push_apart(Context& context, ContactConstraint& constraint) {
  if (!(constraint.k_position > 0)) return;
  const Contact& c = constraint.contact;
  SurfaceMotion& s = *context.surfaces[c.surface];
  Vec3 foot = Vec3::Zero();
  for (int k = 0; k < 3; ++k) foot += c.weights[k] * s.x_t1[c.nodes[k]];
  const double gap = c.normal.dot(context.particles->x_t1[c.particle] - foot);
  const double push = std::max(constraint.push + (constraint.target_gap - gap) / constraint.k_position, 0.0);
  const double change = push - constraint.push;
  if (change == 0) return;
  OILSKIN_ASSERT(push >= 0);
  constraint.push = push;
  context.set_particle_end(c.particle, context.particles->x_t1[c.particle] +
                                           change * context.particles->inverse_mass[c.particle] * c.normal);
  if (!s.nodes_movable) return;
  for (int k = 0; k < 3; ++k) {
    const double u = s.inverse_mass[c.nodes[k]];
    if (c.weights[k] == 0 || u == 0) continue;
    context.set_node_end(c.surface, c.nodes[k], s.x_t1[c.nodes[k]] - change * c.weights[k] * u * c.normal);
  }
}

void apply_friction(Context& context, ContactConstraint& constraint) {
  const SlipModel model =
      context.surfaces[constraint.contact.surface]->slip_on(constraint.contact.back).model;
  if (model == SlipModel::free || (model == SlipModel::viscous_wall && constraint.wall_area == 0)) return;
  if (!constraint.friction_active && !(constraint.friction_load() > 0)) return;
  const Vec3 v = slip_velocity(context, constraint.contact);
  const Vec3 vt = v - v.dot(constraint.contact.normal) * constraint.contact.normal;
  const Vec3 impulse = tangential_impulse(context, constraint, vt);
  const Vec3 change = impulse - constraint.tangential_impulse;
  if (change.isZero(0)) return;
  constraint.tangential_impulse = impulse;
  // The particle's end moves with its velocity; the host moves its nodes itself.
  apply_impulse(context, constraint.contact, change, true);
}

// K along the normal, and the largest one across it (C.38).
void add_body(const BodyMotion& body, const Vec3& arm, ContactConstraint& constraint) {
  const Vec3& n = constraint.contact.normal;
  const Eigen::Matrix3d a = inverse_mass_at(body, arm);
  constraint.k_tangent += largest_across(a, n);
  constraint.k += std::max(0.0, n.dot(a * n));
}

// (C.13): split repulsion removes a tenth of the overlap in a step.
double target_gap(double distance, double thickness) {
  return distance >= thickness ? thickness : distance + 0.1 * (thickness - distance);
}

}  // namespace

Vec3 relative_velocity(const Context& context, const Contact& c) {
  const SurfaceMotion& s = *context.surfaces[c.surface];
  Vec3 v = context.particles->velocity[c.particle];
  if (s.body) return v - velocity_of(s, c);
  for (int k = 0; k < 3; ++k) v -= c.weights[k] * s.velocity[c.nodes[k]];
  return v;
}

ContactConstraint make_constraint(const Context& context, const Contact& contact) {
  const SurfaceMotion& s = *context.surfaces[contact.surface];
  ContactConstraint constraint;
  constraint.contact = contact;
  const double h = s.thickness, d0 = contact.distance;
  constraint.overlap = h - d0;
  constraint.target_gap = target_gap(d0, h);
  constraint.normal_active = comes_within_thickness(context, contact);
  constraint.friction_active = friction_may_act(context, contact);
  constraint.k_position = constraint.k = context.particles->inverse_mass[contact.particle];
  // Not a sum of its own: the order of these sums decides the last bits.
  for (int k = 0; k < 3; ++k)
    constraint.k += contact.weights[k] * contact.weights[k] * s.inverse_mass[contact.nodes[k]];
  constraint.k_tangent = constraint.k;
  if (s.body) add_body(*s.body, arm_of(s, contact), constraint);
  if (s.nodes_movable && !s.body) constraint.k_position = constraint.k;
  OILSKIN_ASSERT(constraint.k_position >= 0 && constraint.k >= constraint.k_position);
  find_turn(context, constraint);
  return constraint;
}

void split_gap_between_opposing_contacts(const Context& context,
                                         std::vector<ContactConstraint>& constraints) {
  for (std::size_t begin = 0, end = 0; begin < constraints.size(); begin = end) {
    while (end < constraints.size() &&
           constraints[end].contact.particle == constraints[begin].contact.particle)
      ++end;
    for (std::size_t k = begin; k < end; ++k) {
      const Contact& c = constraints[k].contact;
      double gap = context.surfaces[c.surface]->thickness;
      for (std::size_t o = begin; o < end; ++o) {
        const Contact& other = constraints[o].contact;
        if (are_opposing(c, other)) gap = std::min(gap, 0.5 * (c.distance + other.distance));
      }
      constraints[k].target_gap = target_gap(c.distance, gap);
      OILSKIN_ASSERT(constraints[k].target_gap >= std::min(c.distance, gap));
    }
  }
}

void solve_constraints(Context& context, std::vector<ContactConstraint>& constraints) {
  OILSKIN_ASSERT(context.settings->solver_iterations >= 1);
  const Repulsion repulsion = context.settings->repulsion;
  const bool split = repulsion == Repulsion::split;
  Squeezes squeezes(context, constraints);
  for (int iteration = 0; iteration < context.settings->solver_iterations; ++iteration) {
    for (ContactConstraint& constraint : constraints) {
      if (!(constraint.k > 0)) continue;  // an immovable particle on prescribed nodes
      if (constraint.normal_active && iteration == 0 && constraint.turn > 0)
        turn(context, constraint, !split);
      if (constraint.normal_active) stop(context, constraint, !split);
      if (constraint.normal_active && repulsion == Repulsion::bridson) spring(context, constraint);
      apply_friction(context, constraint);
      if (constraint.normal_active && split) push_apart(context, constraint);
    }
    squeezes.solve(context);
  }
  for (SurfaceMotion* s : context.surfaces) set_node_velocities(*s);
}

}  // namespace oilskin::contact
