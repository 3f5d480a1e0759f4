// `oilskin effects`: what effects cost, each run in a process of its own, measured once.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "app/program.h"

namespace oilskin::test {
namespace {

using nlohmann::json;

const char* const rain_on_sheet = R"({"host": "mock", "dt": 0.002, "duration": 9, "fluid": {"spacing": 0.01},
  "emitters": [{"shape": "box", "min": [-0.04, 0.004, -0.04], "max": [0.04, 0.044, 0.04], "velocity": [0, -1, 0]}],
  "cloth": [{"grid": [9, 9], "size": [0.2, 0.2], "pins": "corners"}]})";

const std::vector<std::string> configurations = {"none", "wetting", "surface_tension", "viscosity", "all"};

/// Each test has a folder and a scene of its own.
class Effects : public testing::Test {
 protected:
  void SetUp() override { folder.write("sheet.json", rain_on_sheet); }

  /// One short run of each on one thread, unless `more` says otherwise.
  Outcome effects(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"effects", folder.path("sheet.json")};
    const std::pair<const char*, std::string> usual[] = {
        {"--out", folder.path("out")}, {"--threads", "1"}, {"--duration", "0.02"}, {"--repeat", "1"}};
    for (const auto& [name, value] : usual)
      if (std::find(more.begin(), more.end(), name) == more.end())
        arguments.insert(arguments.end(), {name, value});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return oilskin(arguments);
  }
  json report(const std::string& run) const {
    return json::parse(folder.read("out/" + run + "/report.json"), nullptr, false);
  }
  /// Rows of effects.csv by configuration, values by name.
  std::map<std::string, std::map<std::string, std::string>> table() const {
    std::istringstream file(folder.read("out/effects.csv"));
    std::string line;
    std::getline(file, line);
    const std::vector<std::string> names = cells(line);
    std::map<std::string, std::map<std::string, std::string>> rows;
    while (std::getline(file, line)) {
      const std::vector<std::string> values = cells(line);
      EXPECT_EQ(values.size(), names.size()) << line;
      for (std::size_t k = 0; k < std::min(names.size(), values.size()); ++k)
        rows[values[0]][names[k]] = values[k];
    }
    return rows;
  }
  void expect_refused(const Outcome& outcome, const std::vector<std::string>& parts) const {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    for (const std::string& part : parts)
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "no \"" << part << "\" in: " << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path("out/none_1")));
  }

  Folder folder;

 private:
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> all;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) all.push_back(cell);
    return all;
  }
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST_F(Effects, each_configuration_has_its_effects_and_a_row_that_agrees_with_its_reports) {
  const Outcome outcome = effects({"--repeat", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err << outcome.out;
  auto rows = table();
  ASSERT_EQ(rows.size(), configurations.size());
  for (const std::string& name : configurations) {
    auto& row = rows.at(name);
    const json first = report(name + "_1"), second = report(name + "_2");
    EXPECT_EQ(first.at("state_hash"), second.at("state_hash")) << name;
    EXPECT_EQ(row.at("runs"), "2");
    const double walls[] = {first.at("wall_seconds"), second.at("wall_seconds")};
    EXPECT_NEAR(std::stod(row.at("wall_seconds_min")), std::min(walls[0], walls[1]), 1e-5 * walls[0]);
    EXPECT_NEAR(std::stod(row.at("wall_seconds")), 0.5 * (walls[0] + walls[1]), 1e-5 * walls[0]);
    EXPECT_NEAR(std::stod(row.at("seconds_per_simulated_second")), std::stod(row.at("wall_seconds")) / 0.02,
                1e-3 * std::stod(row.at("wall_seconds")) / 0.02);
    EXPECT_EQ(row.at("steps"), first.at("steps").dump());
    EXPECT_EQ(row.at("particles"), first.at("particles").at("alive").dump());
    EXPECT_EQ(std::stod(row.at("effects_seconds")) > 0, name != "none") << name;
    EXPECT_LE(std::stod(row.at("effects_seconds")), std::stod(row.at("stages_seconds")));
    EXPECT_GT(std::stod(row.at("peak_memory_bytes")), 0);
  }
  for (const char* ratio : {"wall_ratio", "cpu_ratio", "memory_ratio"})
    for (const char* end : {"", "_min", "_max"}) EXPECT_EQ(rows.at("none").at(ratio + std::string(end)), "1");
}

TEST_F(Effects, only_the_named_effects_run_and_none_is_the_scene_itself) {
  ASSERT_EQ(effects().exit_code, 0);
  const std::map<std::string, std::vector<std::string>> expected = {
      {"none", {}},
      {"wetting", {"wetting"}},
      {"surface_tension", {"surface_tension"}},
      {"viscosity", {"viscosity"}},
      {"all", {"viscosity", "wetting", "surface_tension"}}};
  std::set<std::string> hashes;
  for (const auto& [name, names] : expected) {
    const json settings = report(name + "_1").at("settings").value("effects", json::object());
    EXPECT_EQ(settings.size(), names.size()) << name << settings;
    for (const std::string& effect : names) EXPECT_TRUE(settings.contains(effect)) << name << effect;
    hashes.insert(report(name + "_1").at("state_hash"));
  }
  EXPECT_EQ(hashes.size(), expected.size()) << "an effect without an effect";
  const json plain = report_of(folder.path("sheet.json"), "0.02", {});
  EXPECT_EQ(plain.at("state_hash"), report("none_1").at("state_hash"));
}

TEST_F(Effects, table_and_plot_name_every_configuration_and_its_settings) {
  ASSERT_EQ(effects().exit_code, 0);
  const std::string table = folder.read("out/effects.md"), plot = folder.read("out/effects.svg");
  for (const std::string& name : configurations) {
    EXPECT_NE(table.find("\n| " + name + " |"), std::string::npos) << table;
    EXPECT_NE(table.find("- `" + name + "`: `effects={"), std::string::npos) << table;
    EXPECT_EQ(count(plot, ">" + name + "</text>"), 2U) << plot;  // time and memory
  }
  EXPECT_NE(table.find("oilskin effects"), std::string::npos);
  EXPECT_EQ(plot.compare(0, 5, "<svg "), 0);
  EXPECT_EQ(plot.substr(plot.size() - 7), "</svg>\n");
  EXPECT_EQ(plot.find("nan"), std::string::npos);
  EXPECT_EQ(plot.find("inf"), std::string::npos);
  // 5 bars of time, of which 4 have a part of the effects, 5 of memory, the background and 2 of the legend.
  EXPECT_EQ(count(plot, "<rect "), 17U) << plot;
}

TEST_F(Effects, runs_that_are_there_are_not_repeated_unless_settings_differ_or_again_is_given) {
  ASSERT_EQ(effects().exit_code, 0);
  const std::string first = folder.read("out/wetting_1/report.json");
  std::filesystem::remove(folder.path("out/effects.csv"));
  const Outcome resumed = effects();
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_EQ(count(resumed.out, "(there already)"), 5U) << resumed.out;
  EXPECT_EQ(folder.read("out/wetting_1/report.json"), first);
  EXPECT_EQ(table().size(), 5U);

  folder.write("out/viscosity_1/report.json", first.substr(0, first.size() / 2));
  std::filesystem::remove(folder.path("out/all_1/report.json"));
  EXPECT_EQ(count(effects().out, "(there already)"), 3U);
  EXPECT_EQ(count(effects({"--repeat", "2"}).out, "(there already)"), 5U);
  EXPECT_EQ(count(effects({"--again"}).out, "(there already)"), 0U);
  EXPECT_NE(folder.read("out/wetting_1/report.json"), first);
  EXPECT_EQ(count(effects({"--set", "fluid.spacing=0.011"}).out, "(there already)"), 0U);
  EXPECT_EQ(count(effects({"--set", "fluid.spacing=0.011", "--threads", "2"}).out, "(there already)"), 0U);
}

TEST_F(Effects, settings_of_the_scene_are_those_of_its_effects) {
  const Outcome outcome = effects({"--set", "effects.viscosity.coefficient=0.03"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("names effects of its own: viscosity"), std::string::npos) << outcome.out;
  EXPECT_EQ(report("none_1").at("settings").value("effects", json::object()).size(), 0U);
  for (const char* run : {"viscosity_1", "all_1"})
    EXPECT_EQ(report(run).at("settings").at("effects").at("viscosity").at("coefficient"), 0.03);
  EXPECT_EQ(table().size(), 5U);
}

TEST_F(Effects, a_failed_check_is_named_and_ends_with_1) {
  const Outcome outcome = effects({"--set", R"(acceptance={"min_emitted": 1000000})"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("the check emitted FAILED"), std::string::npos) << outcome.out;
  EXPECT_NE(folder.read("out/effects.md").find("`wetting`, run 1: the check `emitted` FAILED"),
            std::string::npos);
  EXPECT_EQ(table().at("none").at("checks_hold"), "0");
}

TEST_F(Effects, bad_input_is_refused_before_anything_runs) {
  expect_refused(oilskin({"effects", "jett", "--out", folder.path("out")}), {"nearest is \"jet\""});
  expect_refused(effects({"--duration", "0"}), {"duration"});
  expect_refused(effects({"--repeat", "0"}), {"--repeat"});
  expect_refused(effects({"--set", "fluid.spacig=0.01"}), {"fluid.spacig", "\"spacing\""});
  expect_refused(effects({"--set", "acceptance.min_emited=1"}), {"min_emited"});
  folder.write("file", "");
  expect_refused(effects({"--out", folder.path("file")}), {"--out", "cannot be written"});
}

}  // namespace
}  // namespace oilskin::test
