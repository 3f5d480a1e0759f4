/// Rows of the accumulated Gauss–Seidel: stop, slip and repulsion of one contact each.
#pragma once

#include "contact/context.h"

namespace oilskin::contact {

struct ContactConstraint {
  Contact contact;
  double target_gap = 0;        ///< split: least n·(x1_p − Σ w_i x1_i) at the end [m]
  double overlap = 0;           ///< h − d0 [m], > 0 where the contact begins within the thickness
  bool normal_active = true;    ///< stop and repulsion act
  bool friction_active = true;  ///< slip acts although no normal impulse does (first layer at rest)
  double wall_area = 0;         ///< viscous_wall: of the sheet that the particle stands for [m²]

  // accumulated
  double normal_impulse = 0;  ///< λ ≥ 0 [N s]
  double spring_impulse = 0;  ///< bridson's repulsion, ≥ 0 [N s]
  double push = 0;            ///< split: position multiplier, ≥ 0 [kg m]
  Vec3 tangential_impulse = Vec3::Zero();

  // of the masses
  double k = 0;           ///< K (C.10) [1/kg]
  double k_position = 0;  ///< the same where nodes may be moved, else 1/m_p
};

/// The row of a record at the start positions.
ContactConstraint make_constraint(const Context& context, const Contact& contact);

/// A particle between two layers less than two thicknesses apart cannot keep one from both: rows that face
/// each other share their gap (C.20), so that it comes to rest in the middle. Rows of records, ordered by
/// particle.
void split_gap_between_opposing_contacts(const Context& context, std::vector<ContactConstraint>& constraints);

/// Sweeps over rows in their order: impulses to velocities (both ways), displacements to end positions.
void solve_constraints(Context& context, std::vector<ContactConstraint>& constraints);

}  // namespace oilskin::contact
