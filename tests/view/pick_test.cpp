// What lies under the mouse.
#include "view/pick.h"

#include <gtest/gtest.h>

#include <random>

#include "view/small_scene.h"

namespace oilskin::demo {
namespace {

using test::small_scene;

TEST(Pick, rays_meet_triangles_where_barycentric_weights_say) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto point = [&] { return Vec3(number(random), number(random), number(random)); };
  int met = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 a = point(), b = point(), c = point(), origin = 3 * point();
    const double u = 0.75 * number(random), v = 0.75 * number(random);
    const Vec3 on_plane = a + u * (b - a) + v * (c - a);
    const double distance = (on_plane - origin).norm();
    const auto hit = hit_on_triangle({origin, (on_plane - origin) / distance}, a, b, c);
    ASSERT_EQ(hit.has_value(), u >= 0 && v >= 0 && u + v <= 1) << u << " " << v;
    if (!hit) continue;
    ++met;
    EXPECT_NEAR(*hit, distance, 1e-9 * distance);
    EXPECT_FALSE(hit_on_triangle({origin, (origin - on_plane) / distance}, a, b, c)) << "behind the ray";
  }
  EXPECT_GT(met, 100);
}

TEST(Pick, the_nearest_surface_is_taken) {
  const Scene scene = small_scene();
  LiveScene live = test::live_scene(scene);
  live.step();
  const Ray down{Vec3(0.02, 0.5, 0.01), Vec3(0, -1, 0)};
  const auto cloth = pick(live.simulation(), scene, down, true);
  ASSERT_TRUE(cloth);
  EXPECT_FALSE(cloth->is_body);
  EXPECT_NEAR(cloth->point.y(), 0, 0.005);
  const Ray up{Vec3(0.02, -0.8, 0.01), Vec3(0, 1, 0)};
  const auto body = pick(live.simulation(), scene, up, true);
  ASSERT_TRUE(body);
  EXPECT_TRUE(body->is_body);
  EXPECT_NEAR(body->point.y(), -0.32, 1e-9);
  const auto behind = pick(live.simulation(), scene, up, false);
  ASSERT_TRUE(behind) << "bodies are looked through";
  EXPECT_FALSE(behind->is_body);
  EXPECT_FALSE(pick(live.simulation(), scene, {Vec3(0.8, 0.5, 0), Vec3(0, -1, 0)}, true));
}

TEST(Pick, a_plane_is_met_in_front_only) {
  const Ray ray{Vec3(0, 0, 2), Vec3(0, 0, -1)};
  const auto hit = hit_on_plane(ray, Vec3(5, 5, 0.5), Vec3(0, 0, 1));
  ASSERT_TRUE(hit);
  EXPECT_LT((*hit - Vec3(0, 0, 0.5)).norm(), 1e-12);
  EXPECT_FALSE(hit_on_plane(ray, Vec3(0, 0, 3), Vec3(0, 0, 1)));
  EXPECT_FALSE(hit_on_plane(ray, Vec3(0, 0, 0), Vec3(1, 0, 0)));
}

}  // namespace
}  // namespace oilskin::demo
