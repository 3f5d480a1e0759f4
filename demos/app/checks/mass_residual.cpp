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
    const double missing = std::max(std::abs(totals.mass_in_fluid() - world.fluid_mass()),
                                    std::abs(totals.mass_in_cloth() - world.absorbed_mass()));
    return {at_most("mass_residual", ratio(missing, totals.mass_emitted), 1e-12)};
  }
};

}  // namespace

std::unique_ptr<Check> make_mass_residual() {
  return std::make_unique<MassResidual>();
}

}  // namespace oilskin::demo
