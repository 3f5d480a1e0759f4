// The level of a pool and the rest of water, on shapes with known results.
#include "geometry/pool.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/cloth_model.h"

namespace oilskin::demo {
namespace {

const Vec3 up(0, 1, 0);

/// A cloth of the scene format as a surface at its rest shape.
SurfaceMotion surface_of(const Cloth& cloth) {
  const ClothModel model = build_cloth(cloth, "cloth.0");
  SurfaceMotion motion;
  motion.x_t1 = model.rest;
  motion.triangles = model.triangles;
  return motion;
}

SurfaceMotion bowl(int nodes, double depth) {
  Cloth cloth;
  cloth.grid = {nodes, nodes};
  cloth.size = {0.5, 0.5};
  cloth.bowl_depth = depth;
  return surface_of(cloth);
}

/// A prism-shaped trough along z: y = |x|, from -0.2 to 0.2, with upright ends.
SurfaceMotion trough() {
  SurfaceMotion motion;
  for (const double z : {0.0, 0.3})
    for (const double x : {-0.2, 0.0, 0.2}) motion.x_t1.push_back(Vec3(x, std::abs(x), z));
  motion.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {0, 1, 2}, {3, 5, 4}};
  return motion;
}

TEST(Pool, a_trough_fills_by_its_cross_section) {
  // The upright ends are seen edge on: they have no area over the plane. Level y: volume y² · 0.3.
  for (const double y : {0.001, 0.05, 0.1, 0.19}) {
    const PoolSurface pool = pool_surface(trough(), up, y * y * 0.3);
    // The ends close it but its border is the whole mesh's: the lowest edge of one triangle only is at 0.2.
    ASSERT_TRUE(pool.in_rim) << y;
    EXPECT_NEAR(pool.height, y, 1e-12);
    EXPECT_NEAR(pool.area, 2 * y * 0.3, 1e-12);
  }
}

TEST(Pool, a_basin_that_cannot_hold_the_water_says_so) {
  EXPECT_FALSE(pool_surface(trough(), up, 1.01 * 0.2 * 0.2 * 0.3).in_rim);
  EXPECT_FALSE(pool_surface(bowl(5, 0), up, 1e-6).in_rim) << "a flat sheet holds nothing";
  SurfaceMotion closed;  // without a border it is no basin
  closed.x_t1 = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  closed.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  EXPECT_FALSE(pool_surface(closed, up, 0.01).in_rim);
}

TEST(Pool, the_bowl_fills_as_its_polynomial_says) {
  // Volume over depth (1 − a²)(1 − b²) filled to the rim: D (0.5/2)² ∫∫ = D · 0.0625 · (4/3)².
  const double full = 0.15 * 0.0625 * 16.0 / 9.0;
  EXPECT_TRUE(pool_surface(bowl(57, 0.15), up, 0.99 * full).in_rim);
  EXPECT_FALSE(pool_surface(bowl(57, 0.15), up, 1.01 * full).in_rim);
  EXPECT_NEAR(pool_surface(bowl(113, 0.15), up, 0.3 * full).height,
              pool_surface(bowl(57, 0.15), up, 0.3 * full).height, 1e-4);
}

TEST(Pool, does_not_care_where_up_is) {
  SurfaceMotion turned = bowl(21, 0.15);
  for (Vec3& x : turned.x_t1) x = Vec3(x.z(), x.x(), x.y());
  const PoolSurface a = pool_surface(bowl(21, 0.15), up, 0.001),
                    b = pool_surface(turned, Vec3(0, 0, 1), 0.001);
  EXPECT_NEAR(a.height, b.height, 1e-15);
  EXPECT_NEAR(a.area, b.area, 1e-15);
}

TEST(Pool, the_middle_is_about_the_deepest_node) {
  const SurfaceMotion cloth = bowl(21, 0.15);
  std::vector<Vec3> water;
  for (int i = 0; i <= 100; ++i) water.push_back(Vec3(0.01, -0.15 + 0.0005 * i, 0));
  for (int i = 0; i < 400; ++i) water.push_back(Vec3(0.1, -0.02, 0));  // hangs outside of the middle
  EXPECT_NEAR(level_in_middle(cloth, water, up, 0.05), -0.15 + 0.0005 * 95, 1e-12);
  EXPECT_EQ(level_in_middle(cloth, {}, up, 0.05), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(fraction_above(water, up, -0.05), 400.0 / 501, 1e-12);
}

TEST(Pool, rest_is_the_root_mean_square_inside_the_box) {
  const std::vector<Vec3> x = {Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(2, 0, 0)};
  const std::vector<Vec3> v = {Vec3(3, 0, 0), Vec3(0, 4, 0), Vec3(100, 0, 0)};
  const Box box = {Vec3::Constant(-1), Vec3::Constant(1)};
  EXPECT_NEAR(rms_speed_within(x, v, box), std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(kinetic_energy_per_mass(v), 0.5 * (9 + 16 + 10000), 1e-9);
  EXPECT_NEAR(kinetic_energy_per_mass(v, std::vector<float>{1, 0.5f, 0.25f}), 0.5 * (9 + 8 + 2500), 1e-9);
  EXPECT_EQ(rms_speed_within({}, {}, box), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace oilskin::demo
