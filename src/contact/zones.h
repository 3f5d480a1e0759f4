/// Impact zones: the last resort, which ends with a certificate for any input (docs/theory/contact.md, "The
/// loop").
#pragma once

#include "contact/detection.h"

namespace oilskin::contact {

/// Rounds after which zones have ended (Lemma 2 of docs/theory/contact.md): rounds 0 to 24 unite, translate
/// and hold zones, round 25 carries violating particles along with their triangles, and round 26 removes
/// those that still violate. Particles of infinite mass that are driven into surfaces can take more rounds.
constexpr int max_zone_rounds = 27;

/// Runs zones until find_violations() returns none, which is the certificate. Each round with violations
/// reduces the number of zones, separates a particle, raises a level or resolves a particle as infeasible, so
/// work is bounded. Before the call, prescribed nodes end where the host proposed.
void run_zones(Context& context, CandidateSet& candidates);

}  // namespace oilskin::contact
