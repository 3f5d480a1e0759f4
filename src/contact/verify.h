/// ContactSolver::count_crossings() on the threads of a step.
#pragma once

#include "core/parallel.h"
#include "oilskin/contact.h"

namespace oilskin::contact {

/// The result does not depend on the number of threads.
std::uint64_t count_crossings(const ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                              const Workers& workers, std::uint64_t* pairs_tested);

}  // namespace oilskin::contact
