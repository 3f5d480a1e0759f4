// Keys of a scene file that change nothing are named, with the reason.
#include "scene/unused_keys.h"

#include <gtest/gtest.h>

#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

TEST(UnusedKeys, keys_without_effect_are_named_with_the_reason) {
  const auto notes = [](const char* text) { return read_scene(parse_json(text, "scene"), ".").notes; };
  using Notes = std::vector<std::string>;
  EXPECT_EQ(notes(R"({"fluid": {"stiffness": 5}})"),
            Notes{"fluid.stiffness has no effect: fluid.solver is not \"mcg03\""});
  EXPECT_EQ(notes(R"({"fluid": {"stiffness": 5, "solver": "mcg03", "tolerance": 0.1}})"),
            Notes{"fluid.tolerance has no effect: fluid.solver is \"mcg03\""});
  EXPECT_EQ(notes(R"({"min_dt": 0.1, "adaptive_dt": true})"),
            Notes{"min_dt has no effect: it is longer than dt"});
  EXPECT_EQ(notes(R"({"min_dt": 0.1})"), Notes{"min_dt has no effect: adaptive_dt is false"});
  EXPECT_EQ(notes(R"({"cloth": [{}, {"fabric": {}}]})"),
            Notes{"cloth.1.fabric has no effect: the scene has no effects.wetting"});
  EXPECT_EQ(notes(R"({"cloth": [{"fabric": {}}], "effects": {"wetting": {}}})"), Notes{});
  EXPECT_EQ(notes(R"({"contact": {"stiffness": 1, "repulsion": "bridson"}})"), Notes{});
  EXPECT_EQ(notes(R"({"surface": {"overlap_depth": 1e-3, "channels": ["wetness"]}})").size(), 2u);
}

TEST(UnusedKeys, the_settings_of_a_report_have_no_keys_to_note) {
  Scene scene;
  scene.cloth.resize(1);
  scene.water_mesh.emplace();
  EXPECT_EQ(read_scene(write_scene(scene), ".").notes, std::vector<std::string>{});
}

}  // namespace
}  // namespace oilskin::demo
