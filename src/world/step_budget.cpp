#include "world/step_budget.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::world {

namespace {

constexpr double forgetting = 0.2;

double follow(double known, double found) {
  return found > known ? found : known + forgetting * (found - known);
}

int whole(double number, int least, int most) {
  return number < least ? least : number < most ? static_cast<int>(number) : most;
}

}  // namespace

StepBudget::Plan StepBudget::plan(double seconds, const Plan& least, const Plan& all) const {
  OILSKIN_ASSERT(seconds > 0 && least.substeps >= 1 && least.substeps <= all.substeps);
  OILSKIN_ASSERT(least.iterations >= 1 && least.iterations <= all.iterations);
  if (!has_learned_) return all;
  const double left = seconds - costs_.step;
  const double shortest = costs_.substep + least.iterations * costs_.iteration;
  Plan plan = all;
  if (shortest > 0) plan.substeps = whole(left / shortest, least.substeps, all.substeps);
  const double of_substep = left / plan.substeps - costs_.substep;
  if (costs_.iteration > 0)
    plan.iterations = whole(of_substep / costs_.iteration, least.iterations, all.iterations);
  return plan;
}

/// The divergence solver of DFSPH counts with the iterations of the density solver, as they go together. A
/// solver without iterations has a fixed cost.
StepBudget::Costs StepBudget::costs_of(const StepReport& r) {
  const StageSeconds& s = r.seconds;
  const double rest = s.neighbours + s.occlusion + s.boundary + s.other_fluid + s.proximity + s.impulses +
                      s.ccd + s.zones + s.effects + s.verify;
  const bool iterates = r.fluid.iterations > 0;
  Costs costs;
  costs.step = s.gather;
  costs.substep = (rest + (iterates ? 0 : s.pressure)) / r.substeps;
  costs.iteration = iterates ? s.pressure / r.fluid.iterations : 0;
  return costs;
}

void StepBudget::learn(const StepReport& report) {
  if (report.substeps < 1) return;
  const Costs found = costs_of(report);
  costs_ = has_learned_ ? Costs{follow(costs_.step, found.step), follow(costs_.substep, found.substep),
                                follow(costs_.iteration, found.iteration)}
                        : found;
  has_learned_ = true;
}

}  // namespace oilskin::world
