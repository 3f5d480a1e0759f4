// A limit of the wall time of a step: what is left out, and that nothing else changes.
#include "world/step_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/cloth_over_floor.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

using world::StepBudget;

/// A step whose sub-steps cost 1 s each, of which each iteration took 0.1 s, and 0.5 s more for the host.
StepReport costly(int substeps, int iterations, double unit = 1) {
  StepReport r;
  r.substeps = substeps;
  r.fluid.iterations = substeps * iterations;
  r.seconds.gather = 0.5 * unit;
  r.seconds.pressure = 0.1 * unit * r.fluid.iterations;
  r.seconds.boundary = unit * (substeps - 0.1 * r.fluid.iterations);
  return r;
}

TEST(StepBudget, leaves_out_iterations_first_and_then_sub_steps) {
  StepBudget budget;
  EXPECT_EQ(budget.plan(1e-9, {1, 2}, {4, 20}).substeps, 4) << "nothing is known yet";
  EXPECT_EQ(budget.plan(1e-9, {1, 2}, {4, 20}).iterations, 20);
  budget.learn(costly(4, 5));  // 0.5 s, and for each sub-step 0.5 s and 0.1 s an iteration
  const auto plan = [&](double seconds) { return budget.plan(seconds, {1, 2}, {4, 20}); };
  EXPECT_EQ(plan(100).substeps, 4);
  EXPECT_EQ(plan(100).iterations, 20);
  EXPECT_EQ(plan(4.6).substeps, 4);
  EXPECT_EQ(plan(4.6).iterations, 5);
  EXPECT_EQ(plan(3.4).substeps, 4) << "4 × (0.5 s + 2 × 0.1 s) and 0.5 s";
  EXPECT_EQ(plan(3.4).iterations, 2);
  EXPECT_EQ(plan(2.7).substeps, 3);
  EXPECT_EQ(plan(2.7).iterations, 2);
  EXPECT_EQ(plan(1e-6).substeps, 1);
  EXPECT_EQ(plan(1e-6).iterations, 2);
  EXPECT_EQ(budget.plan(1e-6, {3, 2}, {4, 20}).substeps, 3);
}

TEST(StepBudget, follows_longer_steps_at_once_and_shorter_ones_slowly) {
  StepBudget budget;
  budget.learn(costly(4, 5));
  budget.learn(costly(4, 5, 10));
  EXPECT_EQ(budget.plan(46, {1, 2}, {4, 20}).iterations, 5);
  budget.learn(costly(4, 5));
  EXPECT_LT(budget.plan(46, {1, 2}, {4, 20}).iterations, 20);
  for (int k = 0; k < 40; ++k) budget.learn(costly(4, 5));
  EXPECT_EQ(budget.plan(46, {1, 2}, {4, 20}).iterations, 20);
}

TEST(StepBudget, a_solver_without_iterations_has_a_fixed_cost) {
  StepBudget budget;
  StepReport r = costly(2, 0);
  r.seconds.pressure = 1;
  budget.learn(r);  // 0.5 s, and 1.5 s for each sub-step
  EXPECT_EQ(budget.plan(3.6, {1, 1}, {2, 50}).substeps, 2);
  EXPECT_EQ(budget.plan(3.4, {1, 1}, {2, 50}).substeps, 1);
  EXPECT_EQ(budget.plan(3.4, {1, 1}, {2, 50}).iterations, 50);
}

/// Sub-steps of 4 ms that water at rest needs at a spacing of 5 mm: those that must stay.
int resting_parts(PressureSolver solver) {
  return solver == PressureSolver::pcisph ? 2 : 1;
}

/// A jet of 8 m/s on a sheet, in steps of 4 ms.
struct JetRun {
  std::uint64_t hash = 0, crossings = 0;
  int limit = 0, left_out = 0, steps_of_least = 0;
  std::uint32_t flags = 0;
};

JetRun run_jet(double step_budget, PressureSolver solver) {
  WorldSettings settings = box(0.5, Vec3(0, -9.81, 0), 1);
  settings.step_budget = step_budget;
  FluidSettings fluid = cut_into(8, 0.5);
  fluid.solver = solver;
  fluid.tolerance = fluid.divergence_tolerance = 1e-4;
  ContactSettings contact;
  contact.verify = true;
  World w(settings, fluid, contact);
  ClothOverFloor<double> sheets;
  sheets.attach_to(w);
  DiscEmitter nozzle;
  nozzle.center = Vec3(0, 0.03, 0);
  nozzle.radius = 0.008;
  nozzle.speed = 8;
  EXPECT_TRUE(w.add_emitter(nozzle).ok());
  JetRun run;
  for (int k = 0; k < 10; ++k) {
    const StepReport& r = w.step(4e-3);
    EXPECT_TRUE(r.status.ok());
    run.limit = r.iteration_limit;
    run.left_out += r.substeps_left_out;
    run.steps_of_least += r.substeps == resting_parts(solver);
    run.crossings += r.contact.crossings_found_by_verify;
    run.flags |= r.flags;
  }
  run.hash = w.state_hash();
  EXPECT_GT(w.particle_count(), 100u);
  return run;
}

TEST(StepBudget, a_tight_one_leaves_what_rest_needs_and_the_fewest_iterations_and_nothing_crosses) {
  for (const PressureSolver solver : {PressureSolver::dfsph, PressureSolver::pcisph}) {
    const JetRun tight = run_jet(1e-9, solver);
    EXPECT_EQ(tight.limit, cut_into(8, 0.5).min_iterations);
    EXPECT_GE(tight.steps_of_least, 9) << "the first step has nothing to learn from";
    EXPECT_GT(tight.left_out, 9);
    EXPECT_NE(tight.flags & flag_budget_limited, 0u);
    EXPECT_EQ(tight.crossings, 0u);
  }
}

TEST(StepBudget, a_wide_one_changes_nothing) {
  const JetRun without = run_jet(0, PressureSolver::dfsph), wide = run_jet(1e6, PressureSolver::dfsph);
  EXPECT_EQ(without.hash, wide.hash);
  EXPECT_EQ(wide.limit, 0);
  EXPECT_EQ(wide.left_out, 0);
  EXPECT_EQ(wide.flags & flag_budget_limited, 0u);
  EXPECT_NE(without.hash, run_jet(1e-9, PressureSolver::dfsph).hash);
}

TEST(StepBudget, bad_ones_are_refused_and_zero_takes_it_away) {
  World w(box(0.5), cut_into(8));
  ASSERT_TRUE(w.set_step_budget(0.25).ok());
  for (const double bad : {-1e-3, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const Status s = w.set_step_budget(bad);
    EXPECT_NE(s.message.find("step_budget"), std::string::npos) << s.message;
    EXPECT_EQ(w.settings().step_budget, 0.25);
    WorldSettings settings;
    settings.step_budget = bad;
    EXPECT_FALSE(World(settings, cut_into(8)).status().ok());
  }
  EXPECT_TRUE(w.set_step_budget(0).ok());
}

}  // namespace
}  // namespace oilskin::test
