/// The mass that was emitted is there or was removed.
#include "checks/check.h"

#include <cmath>

namespace oilskin::demo {
namespace {

class MassResidual : public Check {
 public:
  std::vector<CheckResult> results(const RunEnd& end) override {
    const World& world = end.simulation.world();
    const Totals& totals = end.totals;
    const double alive = world.particle_mass() * static_cast<double>(world.particle_count());
    const double missing = std::abs(totals.mass_emitted - totals.mass_removed - alive);
    return {at_most("mass_residual", ratio(missing, totals.mass_emitted), 1e-12)};
  }
};

}  // namespace

std::unique_ptr<Check> make_mass_residual() {
  return std::make_unique<MassResidual>();
}

}  // namespace oilskin::demo
