/// Normals interpolated over a sheet (docs/theory/contact.md, "Smooth normals").
#pragma once

#include "contact/constraints.h"

namespace oilskin::contact {

/// If the contact's surface has smooth normals, sets the direction of the constraint's impulses (C.35), and
/// the speed of approach that is due to the turn of the sheet alone (C.36).
void smooth_normal(const Context& context, ContactConstraint& constraint);

}  // namespace oilskin::contact
