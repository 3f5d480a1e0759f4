/// detect(x0, x1): all bad pairs, in a fixed order.
#pragma once

#include "contact/candidates.h"

namespace oilskin::contact {

struct Violation {
  double time = 1;  ///< of impact in [0, 1]; 1 for pairs that are only near at the end
  std::uint32_t particle = 0;
  std::uint32_t surface = 0;
  std::uint32_t triangle = 0;
  bool paths_intersect = false;
  bool too_close = false;
};

/// Covers the present x_t1 with candidates and tests every pair that has a point with a new end. With ccd off
/// only the end distance counts. Ordered by (time, particle id, surface, triangle). Empty = the certificate.
std::vector<Violation> find_violations(Context& context, CandidateSet& candidates);

}  // namespace oilskin::contact
