/// Constraints of the accumulated Gauss–Seidel: stop, friction and repulsion of one contact each.
#pragma once

#include "contact/context.h"

namespace oilskin::contact {

struct ContactConstraint {
  Contact contact;
  double target_gap = 0;        ///< g* of (C.13): smallest gap at the end [m]
  double overlap = 0;           ///< h − d0 [m], > 0 if the contact begins within the thickness
  bool normal_active = true;    ///< stop and repulsion act
  bool friction_active = true;  ///< friction acts even without a normal impulse (first layer at rest)
  double wall_area = 0;         ///< area of the wall that the particle represents [m²] (C.19)
  double viscous_share = 0;     ///< sticking with boundary terms: (B.36), 0 = sticks, 1 = viscous wall
  double wall_impulse = 0;      ///< J_w ≥ 0 of (B.33): what wall pressure gave to the particle [N s]
  double spare_load = 0;        ///< J_r ≥ 0 of (B.34): left from the last interval [N s]
  double turn = 0;              ///< approach by the turn of a smooth sheet (C.33) [m/s]
  double max_turn = 0;          ///< tangent of the largest turn of one (C.34)

  // Accumulated
  double normal_impulse = 0;               ///< J_n ≥ 0 [N s]
  double spring_impulse = 0;               ///< J_s ≥ 0, Repulsion::bridson [N s]
  double push = 0;                         ///< X_n ≥ 0, Repulsion::split [kg m]
  Vec3 tangential_impulse = Vec3::Zero();  ///< J_t [N s]

  // From the masses
  double k = 0;           ///< K (C.10) along the normal [1/kg]
  double k_tangent = 0;   ///< the largest K along the sheet: that of a body depends on the direction (C.38)
  double k_position = 0;  ///< K_x of (C.14): K if nodes may be moved, else 1/m_i [1/kg]

  /// The normal impulse of this interval [N s].
  double load() const { return normal_impulse + spring_impulse + wall_impulse; }
  /// The normal impulse that bounds friction [N s].
  double friction_load() const { return load() + spare_load; }
};

/// Two contacts of a particle whose normals are within 60° of opposite.
inline bool are_opposing(const Contact& a, const Contact& b) {
  return a.normal.dot(b.normal) < -0.5;
}

/// The constraint of a contact at the start positions.
ContactConstraint make_constraint(const Context& context, const Contact& contact);

/// Of the particle, relative to the point of the surface [m/s] (C.9).
Vec3 relative_velocity(const Context& context, const Contact& contact);

/// A particle between two layers less than 2 h apart cannot keep h from both: opposing contacts divide the
/// gap (C.20), so that it comes to rest in the middle. Constraints are those of contacts, ordered by
/// particle.
void split_gap_between_opposing_contacts(const Context& context, std::vector<ContactConstraint>& constraints);

/// Makes settings.solver_iterations sweeps over the constraints in their order: impulses change velocities of
/// particles and nodes, displacements change end positions.
void solve_constraints(Context& context, std::vector<ContactConstraint>& constraints);

}  // namespace oilskin::contact
