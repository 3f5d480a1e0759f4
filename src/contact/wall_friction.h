/// Friction of particles that wall pressure carries (docs/theory/boundary.md, "Friction").
#pragma once

#include "contact/constraints.h"

namespace oilskin::contact {

/// Adds the wall impulses of the context to the bounds of friction (B.33): to that of the contact which has
/// the same side of the same surface, and else of a constraint of friction alone, one for each side and
/// direction. What the last interval left is added likewise (B.34). Constraints are those of contacts,
/// ordered by particle, and stay so.
void add_wall_impulses(const Context& context, std::vector<ContactConstraint>& constraints);

/// After the constraints are solved: what their loads leave for the next interval (B.35).
void keep_spare_load(const Context& context, const std::vector<ContactConstraint>& constraints);

}  // namespace oilskin::contact
