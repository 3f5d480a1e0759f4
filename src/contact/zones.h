/// Impact zones: the fail-safe that ends with a certificate whatever the input (docs/theory/contact.md, "The
/// loop").
#pragma once

#include "contact/detection.h"

namespace oilskin::contact {

/// Runs zones until a fresh detection is empty, which is the certificate. Work is bounded: every round with
/// bad pairs lowers the number of zones, spends a nudge, raises a level or gives a particle up. Prescribed
/// nodes still end where the host proposed when it is called.
void run_zones(Context& context, CandidateSet& candidates);

}  // namespace oilskin::contact
