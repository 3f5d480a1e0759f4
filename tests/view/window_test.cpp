// The window under a virtual X server, with events of a real mouse and keyboard.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "view/display.h"
#include "view/small_scene_text.h"

namespace oilskin::test {
namespace {

using nlohmann::json;

class Window : public testing::Test {
 protected:
  // One server for all tests, which follow each other.
  static void SetUpTestSuite() { display_ = std::make_unique<Display>(); }
  static void TearDownTestSuite() { display_.reset(); }
  void SetUp() override { ASSERT_FALSE(display_->name().empty()) << "no virtual X server"; }
  std::string small() const { return folder_.write("small.json", small_scene_text); }

  static std::unique_ptr<Display> display_;
  Folder folder_;
};

std::unique_ptr<Display> Window::display_;

double distance(const json& a, const json& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += std::pow(a[k].get<double>() - b[k].get<double>(), 2);
  return std::sqrt(sum);
}

bool has_steps(const json& line) {
  return line["steps"].get<int>() > 0;
}

TEST_F(Window, space_freezes_the_state_and_s_takes_one_step) {
  const ViewWindow window(*display_, {small()});
  window.until(has_steps);
  window.key("space");
  const json paused = window.until([](const json& line) { return line["paused"].get<bool>(); });
  ASSERT_TRUE(paused.is_object());
  const json later = window.after_frames(10);
  EXPECT_EQ(later["state_hash"], paused["state_hash"]);
  EXPECT_EQ(later["time"], paused["time"]);
  window.key("s");
  const json stepped = window.until([&](const json& line) { return line["steps"] != paused["steps"]; });
  EXPECT_EQ(stepped["steps"].get<int>(), paused["steps"].get<int>() + 1);
  EXPECT_NE(stepped["state_hash"], paused["state_hash"]);
  window.key("space");
  // Far enough that the scene, begun again, is still behind when it is looked at.
  const json far = window.until(
      [&](const json& line) { return line["steps"].get<int>() > stepped["steps"].get<int>() + 500; });
  window.key("r");
  window.until([&](const json& line) { return line["steps"].get<int>() < far["steps"].get<int>(); });
}

constexpr const char* with_nozzle = R"(emitters=[
  { "shape": "disc", "center": [0, 0.15, 0], "direction": [0, -1, 0], "radius": 0.02, "speed": 1 } ])";

TEST_F(Window, arrows_turn_the_nozzle_that_is_shown) {
  const ViewWindow window(*display_, {small(), "--set", with_nozzle});
  window.until(has_steps);
  window.key("space");
  window.until([](const json& line) { return line["paused"].get<bool>(); });
  window.key("Right");
  const json right =
      window.until([](const json& line) { return line["nozzles"][0][1].get<double>() > -0.9999; });
  window.key("Left");
  window.key("Up");
  window.until([&](const json& line) { return distance(line["nozzles"][0], right["nozzles"][0]) > 0.05; });
}

TEST_F(Window, the_mouse_turns_moves_and_zooms_the_camera) {
  const ViewWindow window(*display_, {small()});
  const json before = window.until(has_steps);
  ASSERT_TRUE(before.is_object());
  window.events("mousemove --sync 900 300 mousedown 3 mousemove --sync 1000 340 mouseup 3");
  const json turned =
      window.until([&](const json& line) { return distance(line["eye"], before["eye"]) > 0.01; });
  EXPECT_LT(distance(turned["target"], before["target"]), 1e-9);
  EXPECT_NEAR(distance(turned["eye"], turned["target"]), distance(before["eye"], before["target"]), 1e-9);
  window.events("click 4");
  window.until([&](const json& line) {
    return distance(line["eye"], line["target"]) < 0.95 * distance(before["eye"], before["target"]);
  });
  window.events("mousemove --sync 900 300 mousedown 2 mousemove --sync 960 300 mouseup 2");
  window.until([&](const json& line) { return distance(line["target"], before["target"]) > 0.01; });
}

TEST_F(Window, the_mouse_pulls_the_cloth_and_lets_go) {
  const ViewWindow window(*display_, {small()});
  window.until(has_steps);
  window.events("mousemove --sync 812 400 mousedown 1");
  const json held = window.until([](const json& line) { return line["held"].is_object(); });
  ASSERT_TRUE(held.is_object());
  EXPECT_EQ(held["held"]["cloth"], 0);
  const json start = held["held"]["place"];
  window.events("mousemove --sync 812 300");
  const json pulled = window.until([&](const json& line) {
    return line["held"].is_object() && distance(line["held"]["place"], start) > 0.03 &&
           distance(line["held"]["place"], line["held"]["goal"]) < 0.002;
  });
  ASSERT_TRUE(pulled.is_object());
  EXPECT_GT(pulled["held"]["place"][1].get<double>(), start[1].get<double>() + 0.02) << "upwards";
  EXPECT_EQ(pulled["held"]["node"], held["held"]["node"]);
  EXPECT_EQ(pulled["crossings"], 0);
  window.events("mouseup 1");
  window.until([](const json& line) { return line["held"].is_null(); });
}

TEST_F(Window, shift_pulls_a_body) {
  const ViewWindow window(*display_, {small()});
  window.until(has_steps);
  window.events("mousemove --sync 812 620 mousedown 1");
  EXPECT_TRUE(window.after_frames(4)["held"].is_null()) << "it turns the camera";
  window.events("mouseup 1 keydown shift mousedown 1 keyup shift");
  const json held = window.until([](const json& line) { return line["held"].is_object(); });
  EXPECT_EQ(held["held"]["body"], 0);
  window.events("mouseup 1");
}

TEST_F(Window, a_click_on_a_switch_changes_the_setting) {
  const ViewWindow window(*display_, {small()});
  const json before = window.until(has_steps);
  ASSERT_TRUE(before["settings"]["contact.zones"].get<bool>());
  const json zones = before["places"]["contact.zones"];
  window.click(zones[0], zones[1]);
  const json off =
      window.until([](const json& line) { return !line["settings"]["contact.zones"].get<bool>(); });
  EXPECT_GE(off["steps"].get<int>(), before["steps"].get<int>()) << "without a restart";
  const json tension = window.now()["places"]["effects.surface_tension"];
  window.click(tension[0], tension[1]);
  window.until([](const json& line) { return line["settings"]["effects.surface_tension"].is_object(); });
  const json occlusion = window.now()["places"]["fluid.occlusion"];
  window.click(occlusion[0], occlusion[1]);
  window.until([](const json& line) { return !line["settings"]["fluid.occlusion"].get<bool>(); });
  window.until([](const json& line) { return line["steps"].get<int>() > 2; });
}

TEST_F(Window, pictures_show_the_water_as_it_was_asked_for) {
  ViewWindow window(*display_, {small()});
  window.until([](const json& line) { return line["steps"].get<int>() > 20; });
  const auto picture = [&](const std::string& key, const std::string& water, int number) {
    window.key(key);
    window.until([&](const json& line) { return line["water"] == water; });
    window.key("p");
    window.until([&](const json& line) {
      return line["message"] == "wrote small_" + std::to_string(number) + ".png";
    });
    return read_picture(window.folder().path("small_" + std::to_string(number) + ".png"));
  };
  window.key("space");
  const Picture balls = picture("1", "balls", 0), surface = picture("2", "surface", 1),
                none = picture("4", "none", 2);
  ASSERT_EQ(balls.width, 1280);
  ASSERT_EQ(balls.height, 800);
  EXPECT_GT(balls.count(is_water), 3000);
  EXPECT_GT(surface.count(is_water), 3000);
  EXPECT_EQ(none.count(is_water), 0);
  EXPECT_GT(none.count(is_cloth), balls.count(is_cloth)) << "the cloth under the water";
  EXPECT_NEAR(balls.count(is_water), surface.count(is_water), 0.4 * balls.count(is_water));
  window.key("q");
  EXPECT_EQ(window.wait(), 0);
}

TEST_F(Window, a_script_gives_the_same_state_every_time) {
  const std::string script = folder_.write("script",
                                           "1 grab 812 400\n2 drag 812 350\n4 set contact.ccd=false\n5 "
                                           "release\n6 water clear\n7 screenshot a.png\n");
  json last[2];
  for (json& end : last) {
    ViewWindow window(*display_, {small(), "--script", script, "--frames", "8", "--screenshot", "end.png"});
    EXPECT_EQ(window.wait(), 0) << window.folder().read("err");
    end = window.now();
    EXPECT_GT(read_picture(window.folder().path("a.png")).count(is_cloth), 1000);
    EXPECT_EQ(read_picture(window.folder().path("end.png")).width, 1280);
  }
  EXPECT_EQ(last[0]["frame"], 7);
  EXPECT_EQ(last[0]["steps"], 117) << "7 thirtieths of a second in steps of 2 ms";
  EXPECT_EQ(last[0]["state_hash"], last[1]["state_hash"]);
}

TEST_F(Window, wrong_scripts_and_files_end_with_words) {
  const std::string script = folder_.write("script", "0 fly\n");
  ViewWindow refused(*display_, {small(), "--script", script, "--frames", "3"});
  EXPECT_EQ(refused.wait(), 2);
  EXPECT_NE(refused.folder().read("err").find("\"fly\" is no command"), std::string::npos);
  ViewWindow missing(*display_, {small(), "--script", folder_.path("none")});
  EXPECT_EQ(missing.wait(), 2);
  ViewWindow nowhere(*display_, {small(), "--frames", "1", "--screenshot", folder_.path("none/a.png")});
  EXPECT_EQ(nowhere.wait(), 3);
}

class ShippedScene : public Window, public testing::WithParamInterface<const char*> {};

TEST_P(ShippedScene, is_shown_with_water_and_surfaces) {
  const std::string script = folder_.write("script", "0 orbit 35 15\n");
  ViewWindow window(*display_, {GetParam(), "--frames", "5", "--script", script, "--screenshot", "end.png"});
  EXPECT_EQ(window.wait(), 0) << window.folder().read("err");
  const Picture picture = read_picture(window.folder().path("end.png"));
  EXPECT_GT(picture.count(is_water), 300);
  EXPECT_EQ(window.now()["crossings"], 0);
  const bool has_cloth = std::string(GetParam()) != "vee";
  EXPECT_GE(picture.count(is_cloth), has_cloth ? 500 : 0);
}

INSTANTIATE_TEST_SUITE_P(Window, ShippedScene,
                         testing::Values("jet", "bowl", "vee", "two_sided", "crumple", "wet"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace oilskin::test
