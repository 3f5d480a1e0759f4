// Keys of floating bodies, anchors, sinks and force fields: what is refused, and in which words.
#include <gtest/gtest.h>

#include "app/refused_scene.h"

namespace oilskin::demo {
namespace {

using test::message_of;

TEST(SceneRegions, bodies_that_float_need_a_volume_and_no_motion) {
  const auto body = [](const std::string& keys) { return message_of(R"({"bodies": [{)" + keys + "}]}"); };
  EXPECT_EQ(body(R"("shape": "box", "density": 500)"), "");
  EXPECT_EQ(body(R"("shape": "box", "density": -1)"), "bodies.0.density: is -1, must be >= 0");
  EXPECT_EQ(body(R"("shape": "box", "density": 500, "mass": 1)"),
            "bodies.0.density: is given beside \"mass\": give one of them");
  EXPECT_EQ(body(R"("shape": "plane", "mass": 1)"),
            "bodies.0.mass: needs a body with a volume: box, sphere, mesh or compound");
  EXPECT_EQ(body(R"("shape": "sphere", "density": 1, "motion": {"velocity": [1, 0, 0]})"),
            "bodies.0.density: makes the water move the body, which has a \"motion\" of its own");
  EXPECT_EQ(body(R"("shape": "compound", "boxes": [])"), "bodies.0.boxes: is empty, must have a box or more");
  EXPECT_EQ(body(R"("shape": "compound", "boxes": [{"half_extents": [1, 0, 1]}])"),
            "bodies.0.boxes.0.half_extents: must be > 0 each");
}

TEST(SceneRegions, sinks_and_forces_are_checked) {
  EXPECT_EQ(message_of(R"({"sinks": [{}]})"),
            "sinks.0.box: is missing: a sink needs a \"box\" or a \"ball\"");
  EXPECT_EQ(message_of(R"({"sinks": [{"ball": {"radius": 0}}]})"), "sinks.0.ball.radius: is 0, must be > 0");
  EXPECT_EQ(message_of(R"({"sinks": [{"box": {"min": [1, 0, 0], "max": [0, 1, 1]}}]})"),
            "sinks.0.box.max: must be at least min in every coordinate");
  EXPECT_EQ(message_of(R"({"sinks": [{"box": {"min": [1, 0, 0]}}]})"),
            "sinks.0.box.max: is missing: a corner of the box");
  EXPECT_EQ(message_of(R"({"effects": {"forces": [{"box": {"max": [1, 0, 0]}, "force": "wind"}]}})"),
            "effects.forces.0.box.min: is missing: a corner of the box");
  EXPECT_EQ(message_of(R"({"sinks": [{"bax": {}}]})"),
            "sinks.0.box: is missing: a sink needs a \"box\" or a \"ball\"");
  EXPECT_EQ(message_of(R"({"max_age": 0})"), "max_age: is 0, must be > 0");
  EXPECT_EQ(message_of(R"({"effects": {"forces": [{}]}})"),
            "effects.forces.0.force: is missing: uniform, vortex or wind");
  EXPECT_EQ(message_of(R"({"effects": {"forces": [{"force": "vortex", "radius": 0}]}})"),
            "effects.forces.0.radius: is 0, must be > 0");
  EXPECT_EQ(message_of(R"({"effects": {"forces": [{"force": "wind", "speed": 3}]}})").substr(0, 30),
            "effects.forces.0.speed: this k");
  EXPECT_EQ(message_of(R"({"cloth": [{"anchors": [{}]}]})"),
            "cloth.0.anchors.0.within: is missing: the box whose nodes are anchored");
  EXPECT_EQ(message_of(R"({"acceptance": {"drained": {}}})"), "acceptance.drained: the scene has no sinks");
  EXPECT_EQ(message_of(R"({"bodies": [{"shape": "box"}], "acceptance": {"floats": [{"body": 0}]}})"),
            "acceptance.floats.0.body: is 0, must be the index of a body with a mass or density");
  EXPECT_EQ(
      message_of(
          R"({"bodies": [{"shape": "box", "mass": 1}], "acceptance": {"floats": [{"body": 0, "tank": 0}]}})"),
      "acceptance.floats.0.tank: is 0, must be the index of a tank, in a scene whose gravity is along -y");
}

TEST(SceneEmitters, motions_and_ages_are_checked) {
  const auto disc = [](const std::string& keys) {
    return message_of(R"({"emitters": [{"shape": "disc", )" + keys + "}]}");
  };
  EXPECT_EQ(
      disc(R"("motion": {"velocity": [1, 0, 0], "spin_rate": 3}, "max_age": 2, "inherits_motion": false)"),
      "");
  EXPECT_EQ(disc(R"("max_age": 0)"), "emitters.0.max_age: is 0, must be > 0");
  EXPECT_EQ(disc(R"("max_age": "old")"), "emitters.0.max_age: is \"old\", must be a number, > 0");
  EXPECT_EQ(disc(R"("inherits_motion": 1)"), "emitters.0.inherits_motion: is 1, must be true or false");
  EXPECT_EQ(disc(R"("motion": {"spin_axis": [0, 0, 0]})"),
            "emitters.0.motion.spin_axis: is too short, must be longer than 1e-9");
  EXPECT_EQ(disc(R"("motion": {"start": -1})"), "emitters.0.motion.start: is -1, must be >= 0");
  EXPECT_EQ(disc(R"("motion": {"start": 2, "stop": 1})"), "emitters.0.motion.stop: is before \"start\"");
  EXPECT_EQ(disc(R"("start": 2, "stop": 1)"), "emitters.0.stop: is before \"start\"");
  EXPECT_EQ(disc(R"("motion": {"speed": 1})").substr(0, 50),
            "emitters.0.motion.speed: this key is not known; kn");
  EXPECT_EQ(disc(R"("motion": [1, 0, 0])").substr(0, 18), "emitters.0.motion:");
}

}  // namespace
}  // namespace oilskin::demo
