/// What slides over the edges of a smooth sheet keeps its speed (docs/theory/contact.md, "Smooth sheets").
#pragma once

#include "contact/constraints.h"

namespace oilskin::contact {

/// If the contact's surface is smooth, sets the speed of approach that the turn of the sheet alone makes
/// (C.33), and its limit (C.34).
void find_turn(const Context& context, ContactConstraint& constraint);

/// The part of the approach v_n of (C.34), 0 if there is none, for the present relative velocity [m/s].
double speed_to_turn(const ContactConstraint& constraint, double normal_speed, double tangential_speed);

}  // namespace oilskin::contact
