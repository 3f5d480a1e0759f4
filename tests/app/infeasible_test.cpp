// Prescribed surfaces that close on water: what each policy does with it, and that report.json counts it.
#include <gtest/gtest.h>

#include "app/program.h"

namespace oilskin::test {
namespace {

// Pins of cloth may be held for an interval, bodies may not.
const char* const pinned_cloths = R"("cloth": [
    {"grid": [9, 9], "size": [0.08, 0.08], "center": [0, 0, 0], "substeps": 1, "iterations": 1,
     "pins": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}}]},
    {"grid": [9, 9], "size": [0.08, 0.08], "center": [0, 0.02, 0], "substeps": 1, "iterations": 1,
     "pins": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "motion": {"velocity": [0, -5, 0]}}]}])";

const char* const two_bodies = R"("bodies": [
    {"shape": "box", "center": [0, -0.02, 0], "half_extents": [0.04, 0.02, 0.04]},
    {"shape": "box", "center": [0, 0.04, 0], "half_extents": [0.04, 0.02, 0.04], "motion": {"velocity": [0, -5, 0]}}])";

const char* const body_and_pinned_cloth = R"("cloth": [
    {"grid": [9, 9], "size": [0.08, 0.08], "center": [0, 0, 0], "substeps": 1, "iterations": 1,
     "pins": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}}]}],
    "bodies": [{"shape": "box", "center": [0, 0.04, 0], "half_extents": [0.04, 0.02, 0.04],
                "motion": {"velocity": [0, -5, 0]}}])";

struct Closing {
  const char* name;
  const char* surfaces;
  bool holdable;
};

const Closing closings[] = {{"pinnedCloths", pinned_cloths, true},
                            {"twoBodies", two_bodies, false},
                            {"bodyAndPinnedCloth", body_and_pinned_cloth, false}};

class Infeasible : public testing::TestWithParam<Closing> {
 protected:
  /// report.json after 6 ms: what moves has gone 3 cm, the gap was 2. What the pins compress beyond its
  /// density expands where it escapes, with up to the work that compressed it: the limit of energy_made is 1.
  /// No pressure solver can converge on water that pins squeeze, so any of the six steps may diverge.
  nlohmann::json close(const std::string& policy, int expected_exit) {
    const Folder folder;
    const std::string scene = folder.write("closing.json", R"({"gravity": [0, 0, 0], "duration": 0.006,
      "emitters": [{"shape": "box", "min": [-0.0175, 0.005, -0.0175], "max": [0.0175, 0.015, 0.0175]}],
      "contact": {"verify": true}, "acceptance": {"energy_made": 1, "diverged_steps": 1},
      "kill_box": {"min": [-1, -1, -1], "max": [1, 1, 1]}, )" + std::string(GetParam().surfaces) +
                                                               "}");
    const Outcome outcome = oilskin({"run", scene, "--quiet", "--no-render", "--frames-per-second", "0",
                                     "--out", folder.path("out"), "--set", "contact.infeasible=" + policy});
    EXPECT_EQ(outcome.exit_code, expected_exit) << outcome.err;
    return nlohmann::json::parse(folder.read("out/report.json"), nullptr, false);
  }
};

int number(const nlohmann::json& report, const char* key) {
  return report["contact"][key].get<int>();
}

/// What holds under every policy: no particle is lost uncounted; momentum and mass are recorded.
void expect_books_closed(const nlohmann::json& report) {
  const nlohmann::json& particles = report["particles"];
  EXPECT_GT(particles["emitted"].get<int>(), 50);
  EXPECT_EQ(particles["emitted"].get<int>(), particles["alive"].get<int>() + particles["removed"].get<int>());
  for (const nlohmann::json& check : report["acceptance"]) {
    if (check["name"] != "crossings") {
      EXPECT_TRUE(check["ok"].get<bool>()) << check;
    }
  }
}

TEST_P(Infeasible, stall_holds_pins_and_removes_only_where_nothing_may_be_held) {
  const nlohmann::json report = close("stall", 0);
  EXPECT_EQ(number(report, "crossings_found_by_verify"), 0);
  EXPECT_EQ(number(report, "allowed"), 0);
  if (GetParam().holdable) {
    EXPECT_GT(number(report, "stalled"), 0);
    EXPECT_EQ(number(report, "removed"), 0);
    EXPECT_EQ(report["particles"]["alive"], report["particles"]["emitted"]);
  } else {
    EXPECT_GT(number(report, "removed"), 0);
  }
  expect_books_closed(report);
}

TEST_P(Infeasible, remove_removes_particles_and_counts_them) {
  const nlohmann::json report = close("remove", 0);
  EXPECT_EQ(number(report, "crossings_found_by_verify"), 0);
  EXPECT_EQ(number(report, "stalled"), 0);
  EXPECT_EQ(number(report, "allowed"), 0);
  EXPECT_GT(number(report, "removed"), 0);
  expect_books_closed(report);
}

// The run fails its check: a leak that was allowed is a leak.
TEST_P(Infeasible, allow_lets_particles_through_counts_them_and_verify_finds_them) {
  const nlohmann::json report = close("allow", 1);
  EXPECT_GT(number(report, "crossings_found_by_verify"), 0);
  EXPECT_GT(number(report, "allowed"), 0);
  EXPECT_EQ(number(report, "stalled"), 0);
  EXPECT_EQ(number(report, "removed"), 0);
  EXPECT_EQ(report["particles"]["alive"], report["particles"]["emitted"]);
  expect_books_closed(report);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Infeasible, testing::ValuesIn(closings),
                         [](const testing::TestParamInfo<Closing>& closing) { return closing.param.name; });

}  // namespace
}  // namespace oilskin::test
