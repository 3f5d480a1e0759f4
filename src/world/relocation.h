/// What happens to particles that are too near to a surface which has just appeared.
#pragma once

#include "fluid/particles.h"
#include "world/attachments.h"
#include "world/ledger.h"

namespace oilskin::world {

/// Particles nearer than 2 δ to a new surface get a new place and a new id, or are removed, as are those
/// inside a new solid: the promise needs a start at δ or more. Counts them in report.contact.relocated.
/// Afterwards no active surface is new.
void relocate_particles(const ActiveSurfaces& active, fluid::Particles& particles, std::uint64_t& next_id,
                        const Workers& workers, StepReport& report, Ledger& ledger);

}  // namespace oilskin::world
