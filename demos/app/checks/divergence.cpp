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
    f.integer("lost_too_fast", lost_too_fast_, between(0, 1e9));
  }
  std::vector<CheckResult> results(const RunEnd& end) override {
    const Totals& t = end.totals;
    const double steps = static_cast<double>(std::max<std::uint64_t>(1, t.steps));
    const double made = ratio(std::max(t.max_made, t.max_risen), t.energy.scale);
    return {at_most("energy_made", made, energy_made_),
            at_most("diverged_steps", static_cast<double>(t.diverged_steps) / steps, diverged_steps_),
            at_most("lost_too_fast", static_cast<double>(t.removed_too_fast), lost_too_fast_)};
  }

 private:
  double energy_made_ = 0.1;      // of the scale of energies at the end
  double diverged_steps_ = 0.05;  // fraction of the steps whose pressure loop grew
  int lost_too_fast_ = 0;         // particles
};

}  // namespace

std::unique_ptr<Check> make_divergence() {
  return std::make_unique<Divergence>();
}

}  // namespace oilskin::demo
