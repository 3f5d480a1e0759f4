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
const std::set<std::string> known_to_miss = {"sloshing: ω² [1/s²]", "buoyancy: lift [N]",
                                             "free_cloth: speed of the water [m/s]",
                                             "free_cloth: speed of the sheet [m/s]"};

class CoarsestSpacing : public testing::TestWithParam<const char*> {};

TEST_P(CoarsestSpacing, reaches_its_tolerances) {
  const ValidationCase& of = validation_case(GetParam());
  const CaseRun run = run_case(of, of.spacings.front(), Variation(), 1, make_mock_simulation, [](double) {});
  EXPECT_EQ(run.failure, "");
  EXPECT_EQ(run.crossings, 0u);
  EXPECT_GT(run.cost.particles, 0u);
  ASSERT_FALSE(run.quantities.empty());
  for (const Quantity& q : run.quantities) {
    const bool misses = known_to_miss.count(of.name + ": " + q.name) > 0;
    EXPECT_TRUE(std::isfinite(q.value)) << q.name;
    EXPECT_EQ(std::string(verdict(of, run, q)) == "MISSED", misses) << q.name << " is " << q.value;
    test::record(q.name, q.value);
  }
}

INSTANTIATE_TEST_SUITE_P(cases, CoarsestSpacing,
                         testing::Values("sheet_levels", "equal_heads", "buoyancy", "vessels", "arch", "pins",
                                         "hammock", "bag", "free_cloth", "sloshing", "torricelli", "drift"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace oilskin::demo
