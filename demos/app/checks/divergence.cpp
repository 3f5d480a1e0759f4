/// The run is that of water: no energy out of nothing, no pressure that grows, nothing lost at impossible
/// speeds.
#include <algorithm>

#include "checks/check.h"

namespace oilskin::demo {
namespace {

class Divergence : public Check {
 public:
  void describe(Fields& f) override {
    f.number("energy_made", energy_made_, not_negative());
    f.number("diverged_steps", diverged_steps_, not_negative());
  }
  std::vector<CheckResult> results(const RunEnd& end) override {
    const Totals& t = end.totals;
    const double steps = static_cast<double>(std::max<std::uint64_t>(1, t.steps));
    return {at_most("energy_made", std::max(t.max_made_fraction, t.max_risen_fraction), energy_made_),
            at_most("diverged_steps", static_cast<double>(t.diverged_steps) / steps, diverged_steps_),
            at_most("lost_too_fast", static_cast<double>(t.removed_too_fast), 0)};
  }

 private:
  double energy_made_ = 0.1;      // of the scale of energies
  double diverged_steps_ = 0.05;  // fraction of the steps whose pressure loop grew
};

}  // namespace

std::unique_ptr<Check> make_divergence() {
  return std::make_unique<Divergence>();
}

}  // namespace oilskin::demo
