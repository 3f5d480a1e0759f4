/// The checks by which a scene says whether it did what it should.
#pragma once

#include "measurements.h"
#include "totals.h"

namespace oilskin::demo {

struct CheckResult {
  std::string name;
  double value = 0, limit = 0;
  bool ok = false;
};

/// Every check that applies to the scene, after the run. `simulation` is as the last step left it.
std::vector<CheckResult> check_acceptance(const Scene& scene, const Totals& totals,
                                          const Measurements& measured, Simulation& simulation,
                                          const SimulationOptions& options);

}  // namespace oilskin::demo
