// Runs of thousands of steps: nothing crosses, nothing drifts, memory does not grow. The wringing of the bag
// also in a few hundred steps, for every day.
#include <gtest/gtest.h>

#include "app/program.h"

namespace oilskin::test {
namespace {

using Settings = std::vector<std::string>;

/// The bag in coarse water, gripped at `from` [s] and turned until the end, each hand through `angle` [rad].
Settings wringing(double from, double seconds, double angle) {
  const std::string rate = std::to_string(angle / (seconds - from)), start = std::to_string(from);
  Settings set = {"fluid.spacing=0.01", "acceptance.min_emitted=1000",
                  "acceptance.enclosed_volume.from=" + start};
  for (const std::string hand : {"0", "1"}) {
    const std::string pins = "cloth.0.pins." + hand, sign = hand == "0" ? "" : "-";
    set.insert(set.end(), {pins + ".hold=" + start, pins + ".motion.start=" + start,
                           pins + ".motion.stop=" + std::to_string(seconds),
                           pins + ".motion.velocity=[0, 0, 0]", pins + ".motion.spin_rate=" + sign + rate});
  }
  return set;
}

/// report.json of a run that ends with `exit_code`.
nlohmann::json run_for(const std::string& scene, double seconds, const Settings& settings,
                       int exit_code = 0) {
  const Folder folder;
  Settings arguments = {"run", scene,   "--quiet",     "--no-render", "--frames-per-second",
                        "0",   "--out", folder.path(), "--duration",  std::to_string(seconds)};
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  const Outcome outcome = oilskin(arguments);
  const std::string text = folder.read("report.json");
  EXPECT_EQ(outcome.exit_code, exit_code) << scene << ": " << outcome.err << text;
  return nlohmann::json::parse(text, nullptr, false);
}

/// Whether a check of the run holds; null where there is no such check.
nlohmann::json check_of(const nlohmann::json& report, const std::string& name) {
  for (const auto& check : report["acceptance"])
    if (check["name"] == name) return check["ok"];
  return nullptr;
}

TEST(Wrung, the_bag_loses_nothing) {
  const auto report = run_for("bag", 0.4, wringing(0.15, 0.4, 0.5));
  EXPECT_EQ(report["contact"]["crossings_found_by_verify"], 0);
  EXPECT_EQ(report["contact"]["removed"], 0);
  EXPECT_EQ(check_of(report, "inside_changed"), true);
  EXPECT_EQ(report["particles"]["alive"], report["particles"]["emitted"]);
}

// Without the continuous test the bag leaks, and the count inside says so, by its own route.
TEST(Wrung, without_the_continuous_test_the_count_inside_changes) {
  Settings settings = wringing(0.05, 0.06, 0);
  settings.insert(settings.end(),
                  {"contact.ccd=false", "contact.zones=false", "emitters.0.velocity=[0, -20, 0]"});
  const auto report = run_for("bag", 0.06, settings, 1);
  EXPECT_GT(report["contact"]["crossings_found_by_verify"].get<int>(), 0);
  EXPECT_EQ(check_of(report, "inside_changed"), false);
}

/// The bag wrung until `stop` [s] and held so; its memory may grow by `growth`, relative.
void expect_the_wrung_bag_keeps_all(double stop, double seconds, double growth) {
  Settings settings = wringing(0.4, stop, 0.5);
  settings.push_back("acceptance.memory_growth=" + std::to_string(growth));
  const auto report = run_for("bag", seconds, settings);
  EXPECT_EQ(report["steps"], 1000 * seconds);
  EXPECT_EQ(report["contact"]["removed"], 0);
  EXPECT_EQ(report["particles"]["alive"], report["particles"]["emitted"]);
}

// The tighter it is, the more triangles lie between neighbours and the more records there are: 9 %.
TEST(LongRun, the_bag_is_wrung_for_ten_thousand_steps) {
  expect_the_wrung_bag_keeps_all(10, 10, 0.15);
}

TEST(LongRun, the_wrung_bag_is_held_for_four_thousand_steps) {
  expect_the_wrung_bag_keeps_all(1, 5, 0.05);
}

TEST(LongRun, the_crumpled_cloth_lies_for_five_thousand_steps) {
  const auto report = run_for(
      "crumple", 5, {"fluid.spacing=0.008", "acceptance.min_emitted=500", "acceptance.memory_growth=0.05"});
  EXPECT_EQ(report["steps"], 5000);
}

}  // namespace
}  // namespace oilskin::test
