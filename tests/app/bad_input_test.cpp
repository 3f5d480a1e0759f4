// Bad input is refused with exit code 2 and a message that says where the fault lies and what would be right.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "app/program.h"

namespace oilskin::test {
namespace {

/// Runs a scene file and expects to be refused with all of `parts` in the message.
void expect_refused(const std::string& json, const std::vector<std::string>& parts,
                    const std::vector<std::string>& more = {}) {
  const Folder folder;
  std::vector<std::string> arguments = {
      "run", folder.write("scene.json", json), "--out", folder.path("out"), "--frames-per-second", "0"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = oilskin(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << json << outcome.out;
  for (const std::string& part : parts)
    EXPECT_NE(outcome.err.find(part), std::string::npos) << "no \"" << part << "\" in: " << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path("out/report.json")));
}

const char* const small =
    R"({"host": "mock", "duration": 0.01, "cloth": [{"grid": [5, 5], "thickness": 0.001}]})";

TEST(BadInput, an_unknown_scene_names_the_nearest_and_all) {
  const Outcome outcome = oilskin({"run", "jett"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("the nearest is \"jet\""), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("bowl"), std::string::npos) << outcome.err;
}

TEST(BadInput, a_scene_file_that_is_not_there_is_named) {
  const Outcome outcome = oilskin({"run", "/nowhere/scene.json"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("/nowhere/scene.json"), std::string::npos) << outcome.err;
}

TEST(BadInput, a_window_without_a_display_is_refused_in_words) {
  const Outcome outcome = oilskin({"view", "vee"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("view: "), std::string::npos) << outcome.err;
  EXPECT_TRUE(outcome.err.find("no display") != std::string::npos ||
              outcome.err.find("built without a window") != std::string::npos)
      << outcome.err;
  EXPECT_EQ(oilskin({"view", "vee", "--frames", "0"}).exit_code, 2);
  EXPECT_EQ(oilskin({"view", "vee", "--width", "10"}).exit_code, 2);
}

TEST(BadInput, an_unknown_key_names_its_path_and_the_nearest) {
  expect_refused(R"({"cloth": [{"thicknes": 0.001}]})", {"cloth.0.thicknes", "not known", "\"thickness\""});
  expect_refused(R"({"fluid": {"spacig": 0.001}})", {"fluid.spacig", "\"spacing\""});
  expect_refused(R"({"emitters": [{"shape": "disc", "velocity": [0, 0, 0]}]})", {"emitters.0.velocity"});
  expect_refused(R"({"durration": 1})", {"durration", "\"duration\""});
}

TEST(BadInput, wrong_types_name_key_and_value) {
  expect_refused(R"({"dt": "fast"})", {"dt", "\"fast\"", "number"});
  expect_refused(R"({"gravity": [0, 1]})", {"gravity", "[0,1]", "3 numbers"});
  expect_refused(R"({"cloth": {"grid": [5, 5]}})", {"cloth", "list"});
  expect_refused(R"({"contact": {"ccd": 1}})", {"contact.ccd", "true or false"});
  expect_refused(R"({"cloth": [{"grid": [5.5, 5]}]})", {"cloth.0.grid.0", "whole number"});
  expect_refused(R"({"fluid": {"solver": "pcish"}})", {"fluid.solver", "pcish", "nearest is \"pcisph\""});
  expect_refused(R"([1, 2])", {"object"});
  expect_refused(R"({"dt": 0.001,)", {"not JSON"});
  expect_refused(R"({"dt": 0.001, "dt": 0.002})", {"\"dt\"", "twice"});
}

TEST(BadInput, values_out_of_range_name_the_range) {
  expect_refused(R"({"dt": -0.001})", {"dt", "-0.001", "must be > 0 and at most 1000"});
  expect_refused(R"({"dt": 0})", {"dt"});
  expect_refused(R"({"fluid": {"spacing": 0}})", {"fluid.spacing", "> 0"});
  expect_refused(R"({"fluid": {"support_ratio": 9}})", {"fluid.support_ratio", "from 1.5 to 4"});
  expect_refused(R"({"cloth": [{"areal_density": -1}]})", {"cloth.0.areal_density", "from 1e-06 to 1e+06"});
  expect_refused(R"({"cloth": [{"substeps": 0}]})", {"cloth.0.substeps", "from 1 to"});
  expect_refused(R"({"kill_box": {"min": [1, 1, 1], "max": [0, 0, 0]}})", {"kill_box", "min"});
  expect_refused(R"({"fluid": {"min_iterations": 9, "max_iterations": 3}})", {"max_iterations"});
}

TEST(BadInput, non_finite_numbers_are_refused) {
  expect_refused(R"({"dt": NaN})", {"not JSON"});
  expect_refused(R"({"dt": 1e999})", {"not JSON"});
  expect_refused(small, {"dt", "nan"}, {"--dt", "nan"});
  expect_refused(small, {"duration", "inf"}, {"--duration", "inf"});
  expect_refused(small, {"fluid.spacing"}, {"--set", "fluid.spacing=NaN"});
}

TEST(BadInput, what_is_nested_without_end_is_refused) {
  const std::string deep(50000, '[');
  expect_refused(deep, {"scene.json", "levels deep"});
  expect_refused(small, {"--set fluid", "levels deep"}, {"--set", "fluid=" + deep});
}

TEST(BadInput, a_volume_without_nodes_is_refused) {
  expect_refused(
      R"({"cloth": [{"grid": [5, 5]}], "acceptance": {"enclosed_volume": {"at_least": 2, "at_most": 1.5}}})",
      {"acceptance.enclosed_volume.at_least", "is 2", "1.5"});
}

TEST(BadInput, a_thickness_below_four_delta_names_the_smallest_that_would_do) {
  expect_refused(
      R"({"cloth": [{"grid": [5, 5], "thickness": 1e-5}], "kill_box": {"min": [-2, -2, -2], "max": [2, 2, 2]}})",
      {"cloth.0", "thickness", "1e-05"});
}

TEST(BadInput, a_mesh_index_out_of_range_names_file_and_line) {
  const Folder folder;
  folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  folder.write("scene.json", R"({"cloth": [{"mesh": "bad.obj"}]})");
  const Outcome outcome = oilskin({"run", folder.path("scene.json"), "--out", folder.path("out")});
  EXPECT_EQ(outcome.exit_code, 2);
  for (const char* part : {"cloth.0.mesh", "bad.obj:4", "9", "3 vertices"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

TEST(BadInput, cloths_of_one_world_share_their_sub_steps) {
  expect_refused(R"({"cloth": [{"grid": [5, 5], "substeps": 4}, {"grid": [5, 5], "substeps": 8}]})",
                 {"cloth.1.substeps", "cloth.0"});
}

TEST(BadInput, effects_are_known_once_and_within_range) {
  expect_refused(R"({"effects": {"weting": {}}})", {"effects.weting", "wetting"});
  expect_refused(R"({"effects": {"wetting": {}, "wetting": {}}})", {"wetting", "twice"});
  expect_refused(R"({"effects": {"wetting": {"capacity": 0}}})", {"effects.wetting.capacity"});
  expect_refused(R"({"effects": {"wetting": {"textile": "silk"}}})", {"effects.wetting.textile", "cotton"});
  expect_refused(R"({"effects": {"wetting": {"absorption": -1}}})", {"effects.wetting.absorption"});
  expect_refused(R"({"effects": {"viscosity": {"coefficient": -1}}})", {"effects.viscosity.coefficient"});
  expect_refused(R"({"acceptance": {"wetting": {}}})", {"acceptance.wetting", "effects.wetting"});
  expect_refused(R"({"effects": {"adhesion": {}}})", {"effects.adhesion", "contact_angle"});
  expect_refused(R"({"effects": {"surface_tension": {"coefficient": 0}}})",
                 {"effects.surface_tension.coefficient"});
  expect_refused(R"({"effects": {"surface_tension": {"contact_angle": 181}}})",
                 {"effects.surface_tension.contact_angle"});
}

TEST(BadInput, surfaces_out_of_range_are_refused_before_anything_is_computed) {
  expect_refused(R"({"surface": {"cell": 0.5}})", {"surface", "cell"});
  expect_refused(R"({"surface": {"gap": -1}})", {"surface.gap"});
  expect_refused(R"({"surface": {"mode": "near"}})", {"surface.mode", "touch"});
  expect_refused(R"({"surface": {"wet_saturation": 1.5}})", {"surface.wet_saturation"});
  expect_refused(R"({"surface": {"wet_blend": -1}})", {"surface.wet_blend"});
}

TEST(BadInput, pins_that_hold_nothing_are_refused) {
  expect_refused(R"({"cloth": [{"grid": [5, 5], "pins": [99]}]})", {"cloth.0.pins.0", "99", "24"});
  expect_refused(
      R"({"cloth": [{"grid": [5, 5], "pins": [{"within": {"min": [8, 8, 8], "max": [9, 9, 9]}}]}]})",
      {"cloth.0.pins.0.within"});
}

TEST(BadInput, an_unwritable_folder_is_refused_before_anything_is_computed) {
  const Folder folder;
  folder.write("file", "in the way");
  const Outcome outcome = oilskin({"run", folder.write("s.json", small), "--out", folder.path("file/out")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--out"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out.find('%'), std::string::npos) << outcome.out;
}

TEST(BadInput, pictures_that_cannot_be_drawn_are_refused_when_asked_for) {
  const Folder folder;
  const Outcome outcome =
      oilskin({"run", folder.write("s.json", small), "--out", folder.path("out"), "--render"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--render"), std::string::npos) << outcome.err;
}

TEST(BadInput, overrides_are_read_as_carefully_as_files) {
  expect_refused(small, {"--set dt.", "empty"}, {"--set", "dt.=0.001"});
  expect_refused(small, {"--set fluid", "\"spacing\"", "twice"},
                 {"--set", R"(fluid={"spacing": 0.01, "spacing": 0.02})"});
}

TEST(BadInput, a_name_that_would_write_elsewhere_is_refused) {
  for (const char* name : {"../there", "a/b", "a\\\\b", "..", ".", "a\\u0000b", "a\\nb"})
    expect_refused(R"({"name": ")" + std::string(name) + R"("})", {"name: is", "not a path"});
}

TEST(BadInput, the_command_line_is_checked) {
  EXPECT_EQ(oilskin({}).exit_code, 2);
  EXPECT_EQ(oilskin({"fly"}).exit_code, 2);
  EXPECT_EQ(oilskin({"run"}).exit_code, 2);
  EXPECT_EQ(oilskin({"run", "jet", "--threads", "-1"}).exit_code, 2);
  EXPECT_EQ(oilskin({"run", "jet", "--frames-per-second", "-3"}).exit_code, 2);
  EXPECT_EQ(oilskin({"run", "jet", "--trace", "x", "--trace-steps", "7:3"}).exit_code, 2);
  EXPECT_EQ(oilskin({"run", "jet", "--trace-steps", "3:7"}).exit_code, 2) << "no trace";
  EXPECT_EQ(oilskin({"run", "jet", "--seed", "-1"}).exit_code, 2);
  EXPECT_EQ(oilskin({"run", "jet", "--set", "nonsense"}).exit_code, 2);
  EXPECT_EQ(oilskin({"--help"}).exit_code, 0);
}

}  // namespace
}  // namespace oilskin::test
