// Validation cases at their coarsest spacing.
#include <gtest/gtest.h>

#include <set>

#include "hosts/mock_simulation.h"
#include "study/run/case_judgement.h"
#include "support/record.h"

namespace oilskin::demo {
namespace {

/// Quantities that miss their tolerance, as docs/validation/cases.md says. One that no longer does fails the
/// test: take it out here and there.
const std::set<std::string> known_to_miss = {"sloshing: ω² [1/s²]", "free_cloth: speed of the water [m/s]",
                                             "free_cloth: speed of the sheet [m/s]",
                                             "drift: Σ m/ρ over the volume at rest, farthest"};

/// Quantities that one run has on either side of their tolerance: runs whose steps differ by 1e-6 scatter
/// farther than the distance to it.
const std::set<std::string> known_to_scatter = {"buoyancy: lift [N]", "buoyancy: sideways force / lift",
                                                "hammock: depth of the water / L",
                                                "hammock: vertical reaction [N]"};

class CoarsestSpacing : public testing::TestWithParam<const char*> {};

TEST_P(CoarsestSpacing, reaches_its_tolerances) {
  const ValidationCase& of = validation_case(GetParam());
  const CaseRun run = run_case(of, of.spacings.front(), Variation(), 1, make_mock_simulation, [](double) {});
  EXPECT_EQ(run.failure, "");
  EXPECT_EQ(run.crossings, 0u);
  EXPECT_GT(run.cost.particles, 0u);
  ASSERT_FALSE(run.quantities.empty());
  for (const Quantity& q : run.quantities) {
    EXPECT_TRUE(std::isfinite(q.value)) << q.name;
    if (known_to_scatter.count(of.name + ": " + q.name) > 0) continue;
    const bool misses = known_to_miss.count(of.name + ": " + q.name) > 0;
    EXPECT_EQ(std::string(verdict(of, run, q)) == "MISSED", misses) << q.name << " is " << q.value;
    test::record(q.name, q.value);
  }
}

INSTANTIATE_TEST_SUITE_P(cases, CoarsestSpacing,
                         testing::Values("sheet_levels", "equal_heads", "buoyancy", "vessels", "arch", "pins",
                                         "hammock", "bag", "free_cloth", "sloshing", "torricelli", "drift"),
                         [](const auto& of) { return std::string(of.param); });

class Scattering : public testing::TestWithParam<const char*> {};

TEST_P(Scattering, means_of_runs_are_within_twice_the_tolerances) {
  const ValidationCase& of = validation_case(GetParam());
  constexpr int runs = 4;
  CaseRun mean;
  for (int k = 0; k < runs; ++k) {
    Variation nearly;
    nearly.step = 1 + 1e-6 * k;
    const CaseRun run = run_case(of, of.spacings.front(), nearly, 1, make_mock_simulation, [](double) {});
    EXPECT_EQ(run.crossings, 0u);
    if (k == 0) {
      mean = run;
      for (Quantity& q : mean.quantities) q.value = q.reference = 0;
    }
    ASSERT_EQ(run.quantities.size(), mean.quantities.size());
    for (std::size_t i = 0; i < run.quantities.size(); ++i) {
      mean.quantities[i].value += run.quantities[i].value / runs;
      mean.quantities[i].reference += run.quantities[i].reference / runs;
    }
  }
  for (const Quantity& q : mean.quantities) {
    EXPECT_LE(q.error(), 2 * tolerance_at(of, mean, q)) << q.name << " is " << q.value;
    test::record(q.name + ", mean of runs", q.value);
  }
}

INSTANTIATE_TEST_SUITE_P(cases, Scattering, testing::Values("buoyancy", "hammock"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace oilskin::demo
