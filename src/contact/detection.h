/// Finds all violations of an interval, in a fixed order.
#pragma once

#include "contact/candidates.h"

namespace oilskin::contact {

/// A particle and a triangle whose paths intersect or that are too close at x_t1.
struct Violation {
  double time = 1;  ///< of impact, in [0, 1]; 1 if the pair is only too close
  std::uint32_t particle = 0;
  std::uint32_t surface = 0;
  std::uint32_t triangle = 0;
  bool paths_intersect = false;
  bool too_close = false;
};

/// Refreshes the candidates for the current x_t1 and tests each pair of which a point has a new end. Without
/// settings.ccd only end distances are tested. Ordered by (time, particle id, surface, triangle). An empty
/// result is the certificate.
std::vector<Violation> find_violations(Context& context, CandidateSet& candidates);

}  // namespace oilskin::contact
