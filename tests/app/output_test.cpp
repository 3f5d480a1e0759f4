// What a run writes, and how it ends.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <sstream>

#include "app/program.h"

namespace oilskin::test {
namespace {

const char* const small =
    R"({"host": "mock", "dt": 0.002, "duration": 0.02, "fluid": {"spacing": 0.01, "max_substeps": 1, "cfl": 0.4},
  "emitters": [{"shape": "box", "min": [-0.02, 0.02, -0.02], "max": [0.02, 0.04, 0.02]}],
  "cloth": [{"grid": [9, 9], "size": [0.2, 0.2], "pins": "corners"}], "contact": {"verify": true}})";

TEST(Output, the_report_has_every_key_of_the_format) {
  const Folder folder;
  const auto report = report_of(folder.write("small.json", small), "", {});
  for (const char* key :
       {"scene", "settings", "machine", "steps", "substeps", "simulated_seconds", "wall_seconds",
        "cpu_seconds", "seconds", "particles", "contact", "density_error", "pressure_iterations", "momentum",
        "mass", "energy", "state_hash", "peak_memory_bytes", "acceptance"})
    EXPECT_TRUE(report.contains(key)) << key;
  for (const char* key : {"cloth", "neighbours", "occlusion", "boundary", "pressure", "other_fluid",
                          "proximity", "impulses", "ccd", "zones", "effects", "surface", "output", "verify"})
    EXPECT_TRUE(report["seconds"].contains(key)) << key;
  for (const char* key : {"emitted", "alive", "removed", "absorbed", "blocked_starts", "limited_starts"})
    EXPECT_TRUE(report["particles"].contains(key)) << key;
  for (const char* key : {"candidates", "contacts", "meetings", "zone_rounds", "held", "nudged", "stalled",
                          "removed", "allowed", "delta", "least_distance", "crossings_found_by_verify"})
    EXPECT_TRUE(report["contact"].contains(key)) << key;
  for (const char* key : {"cores", "threads", "compiler", "instruction_set", "precision"})
    EXPECT_TRUE(report["machine"].contains(key)) << key;
  EXPECT_EQ(report["steps"], 10);
  EXPECT_NEAR(report["simulated_seconds"].get<double>(), 0.02, 1e-9);
  EXPECT_GT(report["particles"]["emitted"].get<int>(), 0);
}

TEST(Output, settings_in_the_report_run_to_the_same_state) {
  const Folder folder;
  const auto first = report_of(folder.write("a.json", small), "", {});
  const auto again = report_of(folder.write("b.json", first["settings"].dump()), "", {});
  EXPECT_EQ(first["state_hash"], again["state_hash"]);
  EXPECT_EQ(first["settings"], again["settings"]);
}

TEST(Output, the_series_has_the_numbers_of_the_report_and_the_impulses_of_the_ledger) {
  for (const char* every : {"1", "5", "0"}) {
    const Folder folder;
    oilskin({"run", folder.write("small.json", small), "--quiet", "--no-render", "--frames-per-second", "0",
             "--out", folder.path(), "--duration", "0.2", "--set", std::string("series_every=") + every});
    const auto report = nlohmann::json::parse(folder.read("report.json"));
    if (*every == '0') {
      EXPECT_FALSE(std::filesystem::exists(folder.path("series.csv")));
      continue;
    }
    const auto series = read_series(folder.read("series.csv"));
    const std::size_t rows = series.at("time").size();
    EXPECT_EQ(rows, *every == '1' ? 100u : 20u);
    EXPECT_NEAR(series.at("time").back(), 0.2, 1e-8);
    const auto& energy = report["energy"];
    EXPECT_NEAR(series.at("energy_made").back(), energy["made"].get<double>(),
                1e-8 * energy["scale"].get<double>());
    EXPECT_NEAR(series.at("water_kinetic").back(), energy["water_kinetic"].get<double>(), 1e-8);
    double given = 0, iterations = 0;
    for (std::size_t k = 0; k < rows; ++k) {
      given += series.at("cloth_0_force_y")[k] * 0.2 / static_cast<double>(rows);
      iterations += series.at("iterations")[k];
    }
    const auto& momentum = report["momentum"];
    const double expected =
        momentum["to_free_nodes"][1].get<double>() + momentum["to_prescribed_nodes"][1].get<double>();
    EXPECT_LT(expected, 0);
    EXPECT_NEAR(given, expected, 1e-8 * std::abs(expected));
    EXPECT_NEAR(iterations, 100 * report["pressure_iterations"].get<double>(), 1e-6);
  }
}

TEST(Output, options_reach_the_settings) {
  const Folder folder;
  const auto report = report_of(
      folder.write("a.json", small), "0.01",
      {"--dt", "0.001", "--seed", "7", "--set", "cloth.0.thickness=0.002", "--set", "fluid.viscosity=0"});
  EXPECT_EQ(report["steps"], 10);
  EXPECT_EQ(report["settings"]["seed"], 7);
  EXPECT_EQ(report["settings"]["cloth"][0]["thickness"], 0.002);
  EXPECT_EQ(report["settings"]["fluid"]["viscosity"], 0.0);
}

TEST(Output, adaptive_steps_and_substeps_reach_the_duration_and_are_counted) {
  const Folder folder;
  const std::string scene = folder.write("a.json", small);
  const auto adaptive =
      report_of(scene, "0.0205", {"--set", "adaptive_dt=true", "--set", "emitters.0.velocity=[0,-8,0]"});
  EXPECT_NEAR(adaptive["simulated_seconds"].get<double>(), 0.0205, 1e-12);
  EXPECT_GT(adaptive["steps"], 20) << "0.4 spacings at 8 m/s and more";
  EXPECT_EQ(adaptive["substeps"], adaptive["steps"]);
  EXPECT_EQ(adaptive["contact"]["crossings_found_by_verify"], 0);
  const auto cut =
      report_of(scene, "0.02", {"--set", "fluid.max_substeps=9", "--set", "emitters.0.velocity=[0,-8,0]"});
  EXPECT_EQ(cut["steps"], 10);
  EXPECT_GT(cut["substeps"], 20);
  EXPECT_EQ(cut["contact"]["crossings_found_by_verify"], 0);
}

TEST(Output, quiet_prints_nothing) {
  const Folder folder;
  const Outcome outcome = oilskin({"run", folder.write("a.json", small), "--quiet", "--out",
                                   folder.path("out"), "--frames-per-second", "0"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
}

TEST(Output, a_quiet_run_names_the_checks_that_failed) {
  const Folder folder;
  const Outcome outcome =
      oilskin({"run", "jet", "--out", folder.path("run"), "--duration", "0.005", "--no-render", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("oilskin: jet: checks failed: emitted"), std::string::npos) << outcome.err;
}

TEST(Output, list_names_every_scene) {
  const Outcome outcome = oilskin({"list"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* scene :
       {"jet", "slip", "vee", "rain", "bowl", "high_speed", "sweep", "dam_break", "two_sided"})
    EXPECT_NE(outcome.out.find(scene), std::string::npos) << scene;
}

TEST(Output, a_trace_to_standard_output_holds_nothing_else) {
  const Folder folder;
  const std::string scene = folder.write("a.json", small);
  const Outcome all =
      oilskin({"run", scene, "--out", folder.path("out"), "--trace", "-", "--frames-per-second", "0"});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_EQ(all.out.compare(0, 8, "OILSTEP1"), 0);
  const Outcome part = oilskin({"run", scene, "--out", folder.path("out"), "--trace", folder.path("trace"),
                                "--trace-steps", "0:0", "--frames-per-second", "0"});
  EXPECT_EQ(part.exit_code, 0) << part.err;
  const std::string first = folder.read("trace");
  EXPECT_GT(first.size(), 8u);
  EXPECT_EQ(all.out.compare(0, first.size(), first), 0) << "one step is not the beginning of the whole trace";
  const Outcome none = oilskin({"run", scene, "--out", folder.path("out"), "--trace", folder.path("trace"),
                                "--trace-steps", "9999:9999", "--frames-per-second", "0"});
  EXPECT_NE(none.out.find("the trace is empty"), std::string::npos) << none.out;
}

TEST(Output, a_full_disk_ends_with_three) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  const Folder folder;
  const Outcome outcome = oilskin({"run", folder.write("a.json", small), "--out", folder.path("out"),
                                   "--trace", "/dev/full", "--frames-per-second", "0"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("/dev/full"), std::string::npos) << outcome.err;
}

TEST(Output, a_signal_ends_the_run_after_its_step_and_the_report_is_written) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Folder folder;
    const Outcome outcome = run_program_and_signal(OILSKIN_PROGRAM,
                                                   {"run", folder.write("a.json", small), "--duration", "1e5",
                                                    "--out", folder.path("out"), "--frames-per-second", "0"},
                                                   signal);
    EXPECT_EQ(outcome.exit_code, 128 + signal) << outcome.err;
    const auto report = nlohmann::json::parse(folder.read("out/report.json"), nullptr, false);
    ASSERT_FALSE(report.is_discarded());
    EXPECT_GT(report["steps"].get<int>(), 0);
    EXPECT_EQ(report["stopped_by_signal"], signal);
  }
}

}  // namespace
}  // namespace oilskin::test
