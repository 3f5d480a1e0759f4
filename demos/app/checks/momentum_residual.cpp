/// The change of the fluid's momentum equals the momentum that it exchanged.
#include "checks/check.h"

#include <algorithm>

namespace oilskin::demo {
namespace {

class MomentumResidual : public Check {
 public:
  /// Relative to all that was exchanged; below one particle at 1 m/s there is nothing to compare with.
  std::vector<CheckResult> results(const RunEnd& end) override {
    const double scale = std::max(end.totals.momentum_scale, end.simulation.world().particle_mass());
    return {at_most("momentum_residual", ratio(end.totals.momentum_residual.norm(), scale), 1e-9)};
  }
};

}  // namespace

std::unique_ptr<Check> make_momentum_residual() {
  return std::make_unique<MomentumResidual>();
}

}  // namespace oilskin::demo
