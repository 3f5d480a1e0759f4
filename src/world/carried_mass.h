/// The water that a loaded node carries through its host's next step (docs/theory/contact.md, section 12).
#pragma once

#include "world/attachments.h"

namespace oilskin::world {

/// At the end of a step of dt [s], before the hosts are scattered: books what the added masses took, and sets
/// carried_mass for the next step from the mean load.
void update_carried_mass(double dt, const FluidSettings& fluid, Attachment& a, const Workers& workers,
                         StepReport& report);

/// A new surface, a teleport, a surface that is left out: nothing is carried.
void forget_load(Attachment& a);

/// Of a saved surface with n nodes.
bool is_mean_load(const std::vector<Vec3>& load, std::size_t n);

}  // namespace oilskin::world
