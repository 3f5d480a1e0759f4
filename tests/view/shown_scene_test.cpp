// What goes to the graphics card.
#include "view/shown_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "view/small_scene.h"

namespace oilskin::demo {
namespace {

Vec3 of(const float (&v)[3]) {
  return {double(v[0]), double(v[1]), double(v[2])};
}

TEST(ShownScene, particles_cloth_and_bodies_are_those_of_the_world) {
  LiveScene live = test::live_scene(test::small_scene());
  test::take_steps(live, 10);
  ShownScene shown;
  shown.update(live, {}, 1);
  ASSERT_EQ(shown.particles().size(), live.world().particle_count());
  for (std::size_t i = 0; i < shown.particles().size(); ++i) {
    EXPECT_LT((of(shown.particles()[i].position) - live.world().positions()[i]).norm(), 1e-6);
    EXPECT_GT(shown.particles()[i].radius, 0);
    EXPECT_LE(shown.particles()[i].radius, 0.005001f);
  }
  ASSERT_EQ(shown.surfaces().size(), 2u);
  const ShownMesh& cloth = shown.surfaces()[0];
  EXPECT_EQ(cloth.vertices.size(), 169u);
  EXPECT_EQ(cloth.indices.size(), 3u * 288);
  EXPECT_EQ(cloth.border.size(), 2u * 48);
  EXPECT_EQ(cloth.held.size(), 36u);
  EXPECT_TRUE(shown.surfaces()[1].is_body);
}

TEST(ShownScene, a_nozzle_stands_around_its_mouth_and_turns_with_it) {
  LiveScene live = test::live_scene(test::small_scene("mock", {R"(emitters=[{ "shape": "disc",
    "center": [0, 0.2, 0], "direction": [0, -1, 0], "radius": 0.02, "speed": 1 }])"}));
  ShownScene shown;
  shown.update(live, {}, 1);
  ASSERT_EQ(shown.surfaces().size(), 3u);
  for (const Vec3& direction : {Vec3(0, -1, 0), Vec3(0.6, -0.8, 0)}) {
    ASSERT_TRUE(live.aim_nozzle(0, direction).ok());
    shown.update(live, {}, 1);
    double farthest = 0;
    for (const ShownVertex& v : shown.surfaces()[2].vertices) {
      const Vec3 from = of(v.position) - Vec3(0, 0.2, 0);
      const double along = from.dot(direction);
      EXPECT_NEAR((from - along * direction).norm(), 1.12 * 0.02, 1e-6);
      EXPECT_LT(along, 1e-6);
      farthest = std::max(farthest, -along);
    }
    EXPECT_NEAR(farthest, 0.04, 1e-6);
  }
}

TEST(ShownScene, a_drop_beside_a_cloth_does_not_come_through_it) {
  LiveScene live = test::live_scene(test::small_scene());
  test::take_steps(live, 60);
  ShownScene shown;
  shown.update(live, {}, 1);
  int flat = 0;
  for (const ShownParticle& p : shown.particles()) {
    if (p.height >= p.radius) continue;
    ++flat;
    EXPECT_NEAR(of(p.normal).norm(), 1, 1e-5);
  }
  EXPECT_GT(flat, 10);
}

TEST(ShownScene, edges_of_a_box_are_sharp_and_a_ball_is_smooth) {
  const Scene box = test::small_scene(),
              ball = test::small_scene("mock", {R"(bodies=[{"shape": "sphere", "center": [0, -0.5, 0],
    "radius": 0.1, "thickness": 0.002}])"});
  for (const Scene* scene : {&box, &ball}) {
    LiveScene live = test::live_scene(*scene);
    ShownScene shown;
    shown.update(live, {}, 1);
    for (const ShownVertex& v : shown.surfaces()[1].vertices) {
      const Vec3 normal = of(v.normal);
      ASSERT_NEAR(normal.norm(), 1, 1e-5);
      if (scene == &box) {
        EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1, 1e-5);
      } else {
        EXPECT_GT(normal.dot((of(v.position) - Vec3(0, -0.5, 0)).normalized()), 0.99);
      }
    }
  }
}

TEST(ShownScene, the_water_mesh_is_made_only_where_it_is_shown) {
  LiveScene live = test::live_scene(test::small_scene());
  test::take_steps(live, 3);
  ShownScene shown;
  ShowOptions options;
  shown.update(live, options, 1);
  EXPECT_TRUE(shown.water().vertices.empty());
  options.water = ShownWater::surface;
  shown.update(live, options, 1);
  EXPECT_TRUE(shown.mesh_refusal().empty()) << shown.mesh_refusal();
  ASSERT_GT(shown.water().indices.size(), 300u);
  Box water;
  for (const ShownVertex& v : shown.water().vertices) water.add(of(v.position));
  EXPECT_LT((water.max - water.min - Vec3(0.06, 0.03, 0.06)).norm(), 0.02);
  const std::uint64_t version = shown.version();
  shown.update(live, options, 1);
  EXPECT_EQ(shown.version(), version) << "nothing has changed";
}

TEST(ShownScene, the_ends_of_the_colours_are_those_of_the_scene) {
  const Scene scene = test::small_scene("mock", {"pictures.max_speed=2", "pictures.max_pressure=500"});
  EXPECT_EQ(colour_scale(scene, WaterColour::speed).to, 2);
  EXPECT_EQ(colour_scale(scene, WaterColour::pressure).to, 500);
  EXPECT_EQ(colour_scale(scene, WaterColour::density).from, 900);
}

}  // namespace
}  // namespace oilskin::demo
