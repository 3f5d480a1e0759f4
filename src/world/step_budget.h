/// How much of a step is done where its wall time is limited (WorldSettings::step_budget).
#pragma once

#include "oilskin/report.h"

namespace oilskin::world {

/// Plans steps by what those before have cost. A longer step counts at once, a shorter one by a fifth. Part
/// of no saved state, since times belong to the machine.
class StepBudget {
 public:
  struct Plan {
    int substeps = 1;
    int iterations = 0;  ///< of the pressure solver, the most in a sub-step
  };

  /// The most that fits in `seconds`: iterations are left out first, down to `least.iterations`, then
  /// sub-steps, down to `least.substeps`. Without a step to learn from, all.
  Plan plan(double seconds, const Plan& least, const Plan& all) const;

  /// From the times of a finished step.
  void learn(const StepReport& report);

 private:
  struct Costs {
    double step = 0, substep = 0, iteration = 0;  // of each one [s]
  };
  static Costs costs_of(const StepReport& report);

  Costs costs_;
  bool has_learned_ = false;
};

}  // namespace oilskin::world
