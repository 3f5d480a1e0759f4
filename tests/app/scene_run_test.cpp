// The shipped scenes: shortened in the default suite, whole in the slow one.
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>

#include "app/program.h"

namespace oilskin::test {
namespace {

struct Short {
  const char* scene;
  const char* duration;
  const char* set = nullptr;  // a key to change, so that what the scene is about happens in time
};

const Short shortened[] = {{"jet", "0.1"},
                           {"slip", "0.22"},
                           {"honey", "0.15"},
                           {"vee", "0.14"},
                           {"rain", "0.3"},
                           {"bowl", "0.15"},
                           {"high_speed", "0.003"},
                           {"sweep", "0.02"},
                           {"dam_break", "0.05"},
                           {"two_sided", "0.15", "cloth.0.pins.1.release=0.02"},
                           {"bag", "0.2", "fluid.spacing=0.012"},
                           {"drop", "0.012"},
                           {"wet", "0.3"},
                           {"crumple", "0.2", "cloth.0.center=[0, 0.225, 0]"},
                           {"float", "0.12", "fluid.spacing=0.02"},
                           {"drain", "0.1", "fluid.spacing=0.008"},
                           {"raft", "0.12", "fluid.spacing=0.02"}};

std::string name_of(const testing::TestParamInfo<Short>& info) {
  return info.param.scene;
}

nlohmann::json short_report(const Short& run, std::vector<std::string> more) {
  if (run.set != nullptr) more.insert(more.end(), {"--set", run.set});
  return report_of(run.scene, run.duration, more);
}

/// Of the water on all surfaces [N s]. With boundary terms water may lie on walls without a contact.
double impulse_on_surfaces(const nlohmann::json& report) {
  double impulse = 0;
  for (const char* nodes : {"to_free_nodes", "to_prescribed_nodes"})
    for (const auto& component : report["momentum"][nodes]) impulse += std::abs(component.get<double>());
  return impulse;
}

class ShortRun : public testing::TestWithParam<Short> {};

TEST_P(ShortRun, keeps_the_promise_and_the_ledgers) {
  const auto report = short_report(GetParam(), {});
  EXPECT_EQ(report["contact"]["crossings_found_by_verify"], 0);
  EXPECT_GT(impulse_on_surfaces(report), 0) << "nothing touched anything: the run is too short";
  EXPECT_EQ(report["acceptance"].size(), 8u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShortRun, testing::ValuesIn(shortened), name_of);

class Threads : public testing::TestWithParam<Short> {};

TEST_P(Threads, do_not_change_a_bit) {
  const auto one = short_report(GetParam(), {"--threads", "1"});
  const auto two = short_report(GetParam(), {"--threads", "2"});
  EXPECT_EQ(one["state_hash"], two["state_hash"]);
  EXPECT_EQ(one["momentum"]["to_free_nodes"], two["momentum"]["to_free_nodes"]);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Threads, testing::ValuesIn(shortened), name_of);

TEST(ShortRunHosts, double_precision_and_the_mock_keep_the_promise_too) {
  for (const char* host : {"bullet64", "mock"}) {
    const auto report = report_of("jet", "0.1", {"--set", std::string("host=") + host});
    EXPECT_EQ(report["machine"]["precision"], "float64") << host;
    EXPECT_EQ(report["contact"]["crossings_found_by_verify"], 0) << host;
    EXPECT_GT(report["contact"]["contacts"].get<int>(), 0) << host;
  }
}

// [Huber2013] Fig. 4, left: repulsion alone lets water through, and verify sees it.
TEST(Leak, without_the_continuous_test_and_zones_crossings_are_counted) {
  const Folder folder;
  const Outcome outcome = oilskin({"run", "jet", "--quiet", "--no-render", "--frames-per-second", "0",
                                   "--out", folder.path(), "--duration", "0.15", "--set", "contact.ccd=false",
                                   "--set", "contact.zones=false", "--set", "acceptance={}"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  const auto report = nlohmann::json::parse(folder.read("report.json"), nullptr, false);
  EXPECT_GT(report["contact"]["crossings_found_by_verify"].get<int>(), 0);
}

/// Whether a check of a run holds; null where there is no such check.
nlohmann::json check_of(const std::string& scene, const std::vector<std::string>& settings,
                        const std::string& name) {
  const Folder folder;
  std::vector<std::string> arguments = {"run", scene,   "--quiet",    "--no-render", "--frames-per-second",
                                        "0",   "--out", folder.path()};
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  const Outcome outcome = oilskin(arguments);
  bool all = true;
  nlohmann::json found;
  const auto report = nlohmann::json::parse(folder.read("report.json"), nullptr, false);
  for (const auto& check : report["acceptance"]) {
    all = all && check["ok"].get<bool>();
    if (check["name"] == name) found = check["ok"];
  }
  EXPECT_EQ(outcome.exit_code, all ? 0 : 1) << outcome.err;
  return found;
}

// A front that is not seen to follow the table must not pass for one that does.
TEST(Checks, the_dam_break_fails_when_it_ends_too_soon_or_is_another) {
  const std::string coarse = "fluid.spacing=0.0057", many = "acceptance.min_emitted=1";
  EXPECT_EQ(check_of("dam_break", {coarse, many, "duration=0.1"}, "dam_front"), false);
  EXPECT_EQ(check_of("dam_break", {coarse, many, "acceptance.dam_break.width=0.04"}, "dam_front"), false);
}

// A drop stays under the sheet by its surface tension alone.
TEST(Checks, the_drop_falls_off_the_sheet_that_it_does_not_wet) {
  EXPECT_EQ(check_of("drop", {}, "at_rest.0"), true);
  EXPECT_EQ(check_of("drop", {"effects.surface_tension.contact_angle=180"}, "at_rest.0"), false);
  EXPECT_EQ(check_of("drop", {"effects={}"}, "at_rest.0"), false);
}

// Fig. 9 of [Huber2013]: the cloth soaks, and sags lower than dry.
TEST(Checks, wet_cloth_absorbs_drips_and_waterproof_cloth_does_not) {
  const std::string coarse = "fluid.spacing=0.008", grid = "cloth.0.grid=[25, 25]", end = "duration=1.2";
  const std::string soaks = R"(acceptance={"wetting": {"min_absorbed": 0.003, "min_released": 1}})";
  const std::string thin = "effects.wetting.capacity=0.1";
  for (const char* check : {"absorbed", "released"}) {
    EXPECT_EQ(check_of("wet", {coarse, grid, end, soaks, thin}, check), true) << check;
    EXPECT_EQ(check_of("wet", {coarse, grid, end, soaks, "cloth.0.waterproof=true"}, check), false) << check;
  }
}

// Water that floats, and water that moves.
TEST(Checks, rest_is_seen_and_motion_is_seen) {
  const Folder folder;
  const std::string scene = folder.write("float.json", R"({"host": "mock", "duration": 0.02,
    "gravity": [0, 0, 0], "emitters": [{"shape": "box", "min": [0, 0, 0], "max": [0.03, 0.03, 0.03]}],
    "acceptance": {"at_rest": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "speed": 0.001}]}})");
  const std::string check = "at_rest.0", moves = "emitters.0.velocity=[0, 0.1, 0]";
  const std::string elsewhere = R"(acceptance.at_rest.0.within={"min": [2, 2, 2], "max": [3, 3, 3]})";
  EXPECT_EQ(check_of(scene, {}, check), true);
  EXPECT_EQ(check_of(scene, {moves}, check), false);
  EXPECT_EQ(check_of(scene, {moves, "acceptance.at_rest.0.speed=0.11"}, check), true);
  EXPECT_EQ(check_of(scene, {elsewhere}, check), false) << "no water was looked at";
  EXPECT_EQ(check_of(scene, {"acceptance.at_rest.0.to=0.05"}, check), false) << "the run ends before";
  EXPECT_EQ(check_of(scene, {"acceptance.at_rest.0.from=0.03"}, check), false) << "the run ends before";
}

// A block of 20 layers, at a step that is too long for it and may not be cut.
TEST(Checks, energy_out_of_nothing_fails_unless_the_scene_allows_it) {
  const Folder folder;
  const std::string scene = folder.write("tall.json", R"({"host": "mock", "duration": 0.3, "dt": 0.016,
    "fluid": {"boundary": "mirrored", "max_substeps": 1},
    "emitters": [{"shape": "box", "min": [-0.03, 0.03, -0.03], "max": [0.03, 0.13, 0.03]}],
    "cloth": [{"grid": [13, 13], "size": [0.1, 0.1], "areal_density": 2, "substeps": 1, "pins": "border"}]})");
  const std::string check = "energy_made", strict = "acceptance.energy_made=0.01";
  EXPECT_EQ(check_of(scene, {strict}, check), false);
  EXPECT_EQ(check_of(scene, {"acceptance.energy_made=1e9"}, check), true);
  EXPECT_EQ(check_of(scene, {strict, "emitters=[]"}, check), true);
}

// A block of water in a rigid bowl, before it has fallen.
TEST(Checks, water_that_hangs_over_its_pool_is_seen) {
  const Folder folder;
  const std::string scene = folder.write("hang.json", R"({"host": "mock", "duration": 0.002,
    "emitters": [{"shape": "box", "min": [-0.05, -0.14, -0.05], "max": [0.05, 0.0, 0.05]}],
    "cloth": [{"bowl_depth": 0.15, "pins": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}}]}],
    "acceptance": {"pool_level": {}, "pool_calm": {}}})");
  EXPECT_EQ(check_of(scene, {}, "pool_level"), false) << "a heap does not lift the pool";
  EXPECT_EQ(check_of(scene, {"acceptance.pool_level.above=20"}, "pool_level"), true);
  EXPECT_EQ(check_of(scene, {"gravity=[0, -1, 0]"}, "pool_calm"), true) << "it has hardly begun to fall";
  EXPECT_EQ(check_of(scene, {"emitters.0.velocity=[0, 0.5, 0]"}, "pool_calm"), false);
  EXPECT_EQ(check_of(scene, {"cloth.0.bowl_depth=0"}, "pool_level"), false) << "a flat sheet is no basin";
}

// A box that has not come to rest in the water yet.
TEST(Checks, what_does_not_float_as_it_should_is_seen) {
  const Folder folder;
  const std::string scene =
      folder.write("box.json", R"({"duration": 0.06, "dt": 0.004, "fluid": {"spacing": 0.01},
    "emitters": [{"shape": "box", "min": [-0.1, 0, -0.1], "max": [0.1, 0.05, 0.1]}],
    "bodies": [{"shape": "tank", "min": [-0.1, 0, -0.1], "max": [0.1, 0.3, 0.1]},
               {"shape": "box", "center": [0, 0.1, 0], "half_extents": [0.03, 0.02, 0.03], "density": 500}],
    "acceptance": {"floats": [{"body": 1, "tank": 0, "travel": 0.05, "window": 0.02}]}})");
  const std::string topples =
      R"(bodies.2={"shape": "box", "center": [0.04, 0.06, 0], "half_extents": [0.03, 0.01, 0.09]})";
  EXPECT_EQ(check_of(scene, {}, "floats.0.upright"), true);
  EXPECT_EQ(check_of(scene, {}, "floats.0.draught"), false);
  EXPECT_EQ(check_of(scene, {}, "floats.0.travel"), false);
  EXPECT_EQ(check_of(scene, {"acceptance.floats.0.tolerance=20"}, "floats.0.draught"), true);
  EXPECT_EQ(check_of(scene, {"acceptance.floats.0.along=[0, -1, 0]", "acceptance.floats.0.travel=0.01"},
                     "floats.0.travel"),
            true);
  EXPECT_EQ(check_of(scene, {"duration=0.3", topples}, "floats.0.upright"), false);
}

// A block that falls into a sink.
TEST(Checks, water_that_does_not_end_in_a_sink_is_seen) {
  const Folder folder;
  const std::string scene = folder.write("fall.json", R"({"host": "mock", "duration": 0.16, "dt": 0.004,
    "emitters": [{"shape": "box", "min": [0, 0, 0], "max": [0.03, 0.03, 0.03]}],
    "sinks": [{"box": {"min": [-1, -1, -1], "max": [1, -0.03, 1]}}], "acceptance": {"drained": {}}})");
  for (const char* check : {"left", "lost", "ledger"}) EXPECT_EQ(check_of(scene, {}, check), true) << check;
  EXPECT_EQ(check_of(scene, {"gravity=[0, 1, 0]"}, "left"), false);
  EXPECT_EQ(check_of(scene, {R"(kill_box={"min": [-1, -0.01, -1], "max": [1, 1, 1]})"}, "lost"), false);
}

// Cloth alone: it falls for good, or it swings from what takes hold of it and calms down.
TEST(Checks, cloth_that_is_caught_calms_down_and_falling_cloth_does_not) {
  const Folder folder;
  for (const std::string host : {"bullet", "mock"}) {
    const std::string scene = folder.write("held.json", R"({"duration": 0.6,
      "cloth": [{"grid": [15, 15], "size": [0.2, 0.2], "substeps": 2,
                 "pins": [{"within": {"min": [-1, -1, -1], "max": [-0.08, 1, 1]}, "hold": 0.1},
                          {"within": {"min": [0.08, -1, -1], "max": [1, 1, 1]}, "hold": 0.1}]}],
      "acceptance": {"energy_decay": {"from": 0.05, "fraction": 0.5, "window": 0.05}}})");
    const std::string check = "energy_decay", kind = "host=" + host;
    EXPECT_EQ(check_of(scene, {kind}, check), true) << host;
    EXPECT_EQ(check_of(scene, {kind, "cloth.0.pins=none"}, check), false) << host;
    EXPECT_EQ(check_of(scene, {kind, "acceptance.energy_decay.from=0.55"}, check), false) << "never reached";
  }
}

// Bullet's collision of soft bodies with triangle meshes throws cloth out of a tank of 12 cm with 10 to 60
// m/s.
TEST(Tank, dry_cloth_falls_onto_its_floor_and_lies_there) {
  const Folder folder;
  const std::string scene = folder.write("tank.json", R"({"duration": 0.4, "dt": 0.002,
    "kill_box": {"min": [-1, -1, -1], "max": [1, 1, 1]},
    "bodies": [{"shape": "tank", "min": [-0.06, -0.1, -0.06], "max": [0.06, 0.1, 0.06], "thickness": 0.001}],
    "cloth": [{"size": [0.05, 0.05], "grid": [9, 9], "center": [0, 0, 0], "pins": "none",
               "areal_density": 0.02, "thickness": 0.001}]})");
  const double mass = 0.05 * 0.05 * 0.02, fall = 0.1 - 0.005, work = mass * 9.81 * fall;
  const std::string near_the_wall = "cloth.0.center=[0.03, 0, 0]",
                    moves = "bodies.0.motion.velocity=[0.2, 0, 0]";
  for (const std::string& set :
       {std::string("host=bullet"), std::string("host=bullet64"), near_the_wall, moves}) {
    const Folder out;
    oilskin({"run", scene, "--quiet", "--no-render", "--frames-per-second", "0", "--out", out.path(), "--set",
             set});
    const auto series = read_series(out.read("series.csv"));
    EXPECT_NEAR(series.at("node_potential").back(), -work, 0.05 * work) << set;
    EXPECT_LT(series.at("node_kinetic").back(), 0.05 * work) << set;
  }
}

// A block of water in a box of cloth, half of it outside.
TEST(Checks, what_is_not_enclosed_is_seen) {
  const Folder folder;
  folder.write("box.obj",
               "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv .1 .1 0\nv 0 0 .1\nv .1 0 .1\nv 0 .1 .1\nv .1 .1 .1\n"
               "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  const std::string scene =
      folder.write("box.json", R"({"host": "mock", "duration": 0.02, "gravity": [0, 0, 0],
    "emitters": [{"shape": "box", "min": [0.02, 0.02, 0.02], "max": [0.08, 0.08, 0.08]}],
    "cloth": [{"mesh": "box.obj", "pins": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}}]}],
    "acceptance": {"inside_constant": {"every": 1}, "enclosed_volume": {"at_least": 4, "at_most": 5.5}}})");
  const std::string away = R"(emitters.0={"shape": "box", "min": [0.22, 0, 0], "max": [0.28, 0.06, 0.06]})";
  EXPECT_EQ(check_of(scene, {}, "inside"), true);
  EXPECT_EQ(check_of(scene, {}, "inside_changed"), true);
  EXPECT_EQ(check_of(scene, {"emitters.0.start=0.0015"}, "inside_changed"), false) << "it came later";
  EXPECT_EQ(check_of(scene, {away}, "inside"), false);
  EXPECT_EQ(check_of(scene, {}, "least_volume"), true);
  EXPECT_EQ(check_of(scene, {"cloth.0.scale=0.9"}, "least_volume"), false);
}

#ifdef OILSKIN_AUDIT

class Audit : public testing::TestWithParam<Short> {};

TEST_P(Audit, finds_no_crossing_in_the_trace) {
  const Folder folder;
  const auto report = short_report(GetParam(), {"--trace", folder.path("trace")});
  // The auditor holds every surface to the δ that the run promised (the least of all surfaces).
  std::ostringstream delta;
  delta << std::setprecision(17) << report["contact"]["delta"].get<double>();
  const Outcome outcome = run_program(OILSKIN_AUDIT, {"--delta", delta.str(), folder.path("trace")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Audit, testing::ValuesIn(shortened), name_of);

TEST(Audit, finds_the_crossings_of_a_run_that_leaks) {
  const Folder folder;
  oilskin({"run", "jet", "--quiet", "--no-render", "--frames-per-second", "0", "--out", folder.path(),
           "--duration", "0.12", "--trace", folder.path("trace"), "--set", "contact.ccd=false", "--set",
           "contact.zones=false"});
  EXPECT_EQ(run_program(OILSKIN_AUDIT, {folder.path("trace")}).exit_code, 1);
}

#endif

class FullRun : public testing::TestWithParam<Short> {};

TEST_P(FullRun, passes_its_own_acceptance) {
  const auto report = report_of(GetParam().scene, "", {});
  for (const auto& check : report["acceptance"]) EXPECT_TRUE(check["ok"].get<bool>()) << check;
}

INSTANTIATE_TEST_SUITE_P(Scenes, FullRun, testing::ValuesIn(shortened), name_of);

}  // namespace
}  // namespace oilskin::test
