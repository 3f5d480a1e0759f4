/// The checks by which a scene says whether it did what it should.
#pragma once

#include "checks/measurements.h"
#include "checks/totals.h"
#include "output/water_surface.h"

namespace oilskin::demo {

struct CheckResult {
  std::string name;
  double value = 0, limit = 0;
  bool ok = false;
};

/// Every check that applies to the scene, after the run. `simulation` is as the last step left it.
std::vector<CheckResult> check_acceptance(const Scene& scene, const Totals& totals,
                                          const Measurements& measured, Simulation& simulation,
                                          const SimulationOptions& options,
                                          const MakeSimulation& make_simulation);

/// Of every frame's surface: closed, apart from cloth and bodies by the gap. Modes that do not keep away fail
/// where they cut.
void check_surfaces(const Scene& scene, const SurfaceTotals& surfaces, std::vector<CheckResult>& checks);

}  // namespace oilskin::demo
