// The commands of keys, panel and script, and the time of the window.
#include "view/viewer.h"

#include <gtest/gtest.h>

#include "view/costs.h"
#include "view/frame_log.h"
#include "view/small_scene.h"

namespace oilskin::demo {
namespace {

constexpr double no_budget = std::numeric_limits<double>::infinity();

struct Opened {
  LiveScene live = test::live_scene(test::small_scene());
  Viewer viewer{live, 640 + panel_width, 480};

  /// Of a point, in the window.
  Vec3 pixel_of(const Vec3& point) const {
    return viewer.camera().pixel(point, 640, 480) + Vec3(panel_width, 0, 0);
  }

  void advance(double wall) { viewer.advance(wall, no_budget); }
  void obey(const std::string& command) {
    const Status status = viewer.obey(command);
    EXPECT_TRUE(status.ok()) << command << ": " << status.message;
  }
};

TEST(Viewer, simulated_time_follows_wall_time_at_its_speed) {
  Opened o;
  o.advance(0.02);
  EXPECT_EQ(o.live.counts().steps, 10u);
  o.obey("speed 0.25");
  for (int k = 0; k < 4; ++k) o.advance(0.02);
  EXPECT_EQ(o.live.counts().steps, 20u);
}

TEST(Viewer, a_pause_freezes_the_state_and_steps_are_single) {
  Opened o;
  o.advance(0.01);
  o.viewer.press("space");
  const std::uint64_t hash = o.live.world().state_hash();
  o.advance(0.1);
  EXPECT_EQ(o.live.world().state_hash(), hash);
  o.viewer.press("s");
  EXPECT_EQ(o.live.counts().steps, 6u);
  EXPECT_NE(o.live.world().state_hash(), hash);
  EXPECT_TRUE(o.viewer.paused());
  o.obey("step 3");
  EXPECT_EQ(o.live.counts().steps, 9u);
  o.obey("run");
  o.advance(0.002);
  EXPECT_EQ(o.live.counts().steps, 10u);
}

TEST(Viewer, what_the_machine_cannot_make_up_is_left_out) {
  Opened o;
  o.viewer.advance(0.1, 0);
  EXPECT_EQ(o.live.counts().steps, 1u);
  o.viewer.advance(0.002, no_budget);
  EXPECT_EQ(o.live.counts().steps, 2u);
}

TEST(Viewer, the_mouse_takes_the_cloth_under_it_and_pulls_it) {
  Opened o;
  o.advance(0.01);
  const Vec3 on_cloth = o.live.simulation().cloth(0)->x_t1[6 * 13 + 6];
  const Vec3 pixel = o.pixel_of(on_cloth);
  ASSERT_TRUE(o.viewer.grab(pixel.x(), pixel.y(), false));
  o.viewer.drag(pixel.x(), pixel.y() - 40);
  o.advance(0.3);
  const Vec3 now = o.pixel_of(o.live.simulation().cloth(0)->x_t1[6 * 13 + 6]);
  EXPECT_NEAR(now.x(), pixel.x(), 2);
  EXPECT_NEAR(now.y(), pixel.y() - 40, 2);
  o.viewer.let_go();
  EXPECT_FALSE(o.live.simulation().grip());
}

TEST(Viewer, the_scene_stands_beside_the_panel_where_there_is_space_for_both) {
  Opened o;
  EXPECT_EQ(o.viewer.left(), panel_width);
  const Ray beside = o.viewer.ray(o.pixel_of(Vec3(0.1, 0, 0)).x(), o.pixel_of(Vec3(0.1, 0, 0)).y());
  o.obey("panel off");
  EXPECT_EQ(o.viewer.left(), 0);
  o.viewer.resize(640, 480);
  const Vec3 pixel = o.viewer.camera().pixel(Vec3(0.1, 0, 0), 640, 480);
  EXPECT_LT((o.viewer.ray(pixel.x(), pixel.y()).direction - beside.direction).norm(), 1e-12);
  o.obey("panel on");
  EXPECT_EQ(o.viewer.left(), 0) << "the window is narrow";
}

TEST(Viewer, static_bodies_are_taken_only_when_asked) {
  Opened o;
  o.advance(0.01);
  const Vec3 pixel = o.pixel_of(Vec3(0.28, -0.28, 0.28));
  EXPECT_FALSE(o.viewer.grab(pixel.x(), pixel.y(), false));
  EXPECT_TRUE(o.viewer.grab(pixel.x(), pixel.y(), true));
  EXPECT_TRUE(o.live.simulation().grip()->is_body);
  o.obey("bodies clear");
  EXPECT_FALSE(o.viewer.grab(pixel.x(), pixel.y(), true)) << "what one sees through is not held";
}

TEST(Viewer, commands_change_what_they_name) {
  Opened o;
  o.obey("water surface");
  EXPECT_EQ(o.viewer.shown().water, ShownWater::surface);
  o.obey("water next");
  EXPECT_EQ(o.viewer.shown().water, ShownWater::clear);
  o.obey("colour density");
  EXPECT_EQ(o.viewer.shown().colour, WaterColour::density);
  o.obey("cut on");
  EXPECT_TRUE(o.viewer.shown().cut);
  o.obey("view 1");
  EXPECT_NEAR(o.viewer.camera().eye().y(), 1, 0.01);
  EXPECT_FALSE(o.viewer.shown().cut) << "as the view says";
  const double distance = o.viewer.camera().distance();
  o.obey("zoom 0.5");
  EXPECT_NEAR(o.viewer.camera().distance(), 0.5 * distance, 1e-12);
  o.obey("orbit 10 -20");
  o.obey("panel off");
  EXPECT_FALSE(o.viewer.panel());
  o.obey("set contact.zones=false");
  EXPECT_FALSE(o.live.world().contact_settings().zones);
  o.obey("screenshot a.png");
  EXPECT_EQ(o.viewer.take_screenshot(), "a.png");
  EXPECT_EQ(o.viewer.take_screenshot(), "");
  o.viewer.press("q");
  EXPECT_TRUE(o.viewer.wants_to_quit());
}

constexpr const char* two_nozzles = R"(emitters=[
  { "shape": "disc", "center": [0, 0.2, 0], "direction": [0, -2, 0], "radius": 0.02, "speed": 1 },
  { "shape": "box", "min": [-0.03, 0.03, -0.03], "max": [0.03, 0.06, 0.03] },
  { "shape": "disc", "center": [0.1, 0.2, 0], "direction": [1, 0, 0], "radius": 0.03, "speed": 1 } ])";

TEST(Viewer, the_jet_of_a_nozzle_turns_to_where_the_arrow_points) {
  LiveScene live = test::live_scene(test::small_scene("bullet", {two_nozzles}));
  Viewer viewer(live, 640, 480);
  ASSERT_EQ(live.simulation().nozzles().size(), 2u);
  const Eigen::Matrix3d axes = viewer.camera().axes();
  const Vec3 before = live.simulation().nozzles()[0].direction;
  EXPECT_EQ(before, Vec3(0, -1, 0));
  for (int k = 0; k < 5; ++k) viewer.press("right");
  const Vec3 right = live.simulation().nozzles()[0].direction;
  EXPECT_NEAR(std::acos(right.dot(before)), 15 * 3.14159265358979323846 / 180, 1e-9);
  EXPECT_NEAR(right.dot(axes.col(0)), std::sin(15 * 3.14159265358979323846 / 180), 1e-9);
  ASSERT_TRUE(viewer.obey("nozzle 0 8").ok());
  EXPECT_GT(live.simulation().nozzles()[0].direction.dot(axes.col(1)), right.dot(axes.col(1)) + 0.02);
  test::take_steps(live, 60);
  double sideways = 0;
  for (const Vec3& x : live.world().positions())
    if (x.y() > 0.1 && x.y() < 0.15 && x.x() < 0.05) sideways = std::max(sideways, x.dot(axes.col(0)));
  EXPECT_GT(sideways, 0.025) << "a jet straight down stays within 0.02 of its axis";
}

TEST(Viewer, the_next_nozzle_is_turned_and_none_is_refused) {
  LiveScene live = test::live_scene(test::small_scene("mock", {two_nozzles}));
  Viewer viewer(live, 640, 480);
  viewer.press("n");
  viewer.press("up");
  EXPECT_EQ(live.simulation().nozzles()[0].direction, Vec3(0, -1, 0));
  EXPECT_LT(live.simulation().nozzles()[1].direction.x(), 0.9999);
  viewer.press("n");
  for (int k = 0; k < 100; ++k) viewer.press("down");
  EXPECT_LT((live.simulation().nozzles()[0].direction + viewer.camera().axes().col(1)).norm(), 0.06);
  for (const char* wrong : {"nozzle", "nozzle 1", "nozzle a b", "nozzle nan 0", "nozzle last"})
    EXPECT_FALSE(viewer.obey(wrong).ok()) << wrong;
  Opened without;
  EXPECT_FALSE(without.viewer.obey("nozzle 1 0").ok());
}

TEST(Viewer, bad_commands_are_refused_and_change_nothing) {
  Opened o;
  o.advance(0.01);
  const Json before = frame_line(0, o.viewer);
  for (const char* wrong : {"",
                            "jump",
                            "step 0",
                            "step 1.5",
                            "step -2",
                            "step x",
                            "speed",
                            "speed 0",
                            "speed -1",
                            "speed nan",
                            "water",
                            "water ice",
                            "colour red",
                            "bodies 3",
                            "cut perhaps",
                            "view 2",
                            "view -1",
                            "view",
                            "orbit 1",
                            "orbit a b",
                            "zoom 0",
                            "zoom",
                            "set",
                            "set contact.zones=perhaps",
                            "set nothing=1",
                            "grab",
                            "grab 1",
                            "grab 0 0",
                            "drag 1",
                            "drag x y",
                            "panel"}) {
    const Status status = o.viewer.obey(wrong);
    EXPECT_FALSE(status.ok()) << wrong;
    EXPECT_EQ(frame_line(0, o.viewer), before) << wrong;
  }
}

TEST(Script, lines_are_frames_and_commands) {
  const auto script =
      parse_script("# a comment\n\n0 pause\n  12 set contact.ccd=false  # off\n12 screenshot b.png\n", "s");
  ASSERT_EQ(script.size(), 3u);
  EXPECT_EQ(script[1].frame, 12u);
  EXPECT_EQ(script[1].command, "set contact.ccd=false");
  EXPECT_EQ(script[2].command, "screenshot b.png");
}

TEST(Script, bad_lines_are_named) {
  for (const char* wrong :
       {"pause\n", "-1 pause\n", "0 run\n3\n", "0 run\n5 pause\n4 run\n", "1.5 pause\n"}) {
    EXPECT_THROW(parse_script(wrong, "file"), SceneError) << wrong;
  }
  try {
    parse_script("0 run\n5 pause\n4 run\n", "file");
  } catch (const SceneError& error) {
    EXPECT_EQ(std::string(error.what()), "file, line 3: frame 4 comes after frame 5");
  }
}

TEST(Costs, every_stage_is_a_part_of_the_bar) {
  StepCosts costs;
  StageSeconds& s = costs.stages;
  double value = 1;
  for (double* stage : {&s.gather, &s.neighbours, &s.pressure, &s.occlusion, &s.boundary, &s.other_fluid,
                        &s.proximity, &s.impulses, &s.ccd, &s.zones, &s.effects, &s.verify})
    *stage = value *= 2;
  static_assert(sizeof(StageSeconds) == 12 * sizeof(double), "a new stage needs a part, and a place here");
  costs.host = 1;
  costs.total = 2 * value + 100;
  const auto parts = cost_parts(costs);
  EXPECT_EQ(sum_of(parts), costs.total);
  EXPECT_EQ(parts.back().seconds, 101);
}

TEST(Costs, the_parts_of_a_real_step_add_up_to_it) {
  Opened o;
  o.advance(0.02);
  const StepCosts& costs = o.live.costs();
  EXPECT_GT(costs.total, 0);
  EXPECT_GT(costs.stages.pressure, 0);
  EXPECT_NEAR(sum_of(cost_parts(costs)), costs.total, 0.2 * costs.total);
}

}  // namespace
}  // namespace oilskin::demo
