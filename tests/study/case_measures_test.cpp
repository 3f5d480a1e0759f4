// References and measures of validation cases.
#include "study/cases/measures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/closed_surface.h"
#include "study/cases/lintearia.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Depth, pull and angle at the rims of a weightless strip filled to its rims, computed apart from this code.
struct FullTrough {
  double gap, depth, area, pull, angle;
};
constexpr FullTrough full[] = {{0.3, 0.39973, 0.123906, -0.015925, 104.416},
                               {0.5, 0.37331, 0.149777, 0.005405, 85.872},
                               {0.7, 0.31431, 0.155407, 0.036418, 64.888},
                               {0.9, 0.19492, 0.114806, 0.077225, 36.624}};

TEST(Lintearia, has_the_shape_and_the_pull_of_a_full_trough) {
  for (const FullTrough& f : full) {
    const TroughShape shape = trough_shape({f.gap, f.area, 0}, 8);
    EXPECT_NEAR(shape.depth, f.depth, 2e-4) << f.gap;
    EXPECT_NEAR(shape.sag, f.depth, 2e-4) << f.gap;
    EXPECT_NEAR(shape.pull, f.pull, 2e-4) << f.gap;
    EXPECT_NEAR(shape.end_angle * 180 / pi, f.angle, 0.1) << f.gap;
  }
}

TEST(Lintearia, a_dry_strip_is_a_catenary) {
  // x = a sinh⁻¹(s/a) and y = √(a² + s²) − a with a = H/w, found from x(½) = 0.35: a = 0.231106.
  const TroughShape shape = trough_shape({0.7, 0, 0.1}, 8);
  EXPECT_NEAR(shape.sag, 0.319720, 1e-5);
  EXPECT_NEAR(shape.pull, 0.1 * 0.231106, 1e-6);
  ASSERT_EQ(shape.points.size(), 17u);
  EXPECT_NEAR(shape.points.front()[0], -0.35, 1e-6);
  EXPECT_NEAR(shape.points.back()[0], 0.35, 1e-6);
}

TEST(Lintearia, the_rims_carry_the_weight) {
  for (const double weight : {0.0, 0.02})
    for (const double area : {0.05, 0.12}) {
      const TroughShape shape = trough_shape({0.7, area, weight}, 8);
      EXPECT_NEAR(2 * shape.pull * std::tan(shape.end_angle), area + weight, 1e-6) << weight << " " << area;
    }
}

SurfaceMotion surface_of(const Mesh& mesh) {
  SurfaceMotion motion;
  motion.x_t1 = mesh.vertices;
  motion.triangles = mesh.triangles;
  return motion;
}

TEST(Shapes, a_ball_is_closed_and_faces_outwards) {
  const SurfaceMotion ball = surface_of(ball_mesh(Vec3(1, 2, 3), 0.5, 12));
  const ClosedSurface surface(ball);
  EXPECT_TRUE(surface.closed());
  EXPECT_NEAR(surface.volume(), pi / 6, 0.01 * pi / 6);
  EXPECT_EQ(surface.winding_number(Vec3(1, 2, 3)), 1);
  EXPECT_EQ(surface.winding_number(Vec3(1, 2, 3.6)), 0);
}

TEST(Shapes, a_prism_over_a_hollow_polygon_has_its_inside) {
  // The letter U.
  const SurfaceMotion prism =
      surface_of(prism_mesh({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 0, 2));
  const ClosedSurface surface(prism);
  EXPECT_TRUE(surface.closed());
  EXPECT_NEAR(surface.volume(), 14, 1e-12);
  EXPECT_EQ(surface.winding_number(Vec3(0.5, 2.4, 1.1)), 1);
  EXPECT_EQ(surface.winding_number(Vec3(1.5, 2.4, 1.1)), 0) << "between the arms";
}

TEST(Shapes, water_around_a_hole_fills_the_rest_once) {
  const Box outer = {Vec3::Zero(), Vec3(4, 5, 6)}, hole = {Vec3(1, 1, 2), Vec3(2, 4, 3)};
  double volume = 0;
  for (const Emitter& emitter : water_around(outer, hole)) {
    const Box& box = std::get<FilledBox>(emitter.shape).box;
    const Vec3 size = box.max - box.min;
    EXPECT_GT(size.minCoeff(), 0);
    const Vec3 middle = 0.5 * (box.min + box.max);
    EXPECT_FALSE(hole.contains(middle));
    volume += size.prod();
  }
  EXPECT_NEAR(volume, 4 * 5 * 6 - 1 * 3 * 1, 1e-12);
}

TEST(Measures, of_water_in_a_box) {
  World world;
  std::vector<Vec3> x;
  for (int k = 0; k < 100; ++k) x.emplace_back(0.02 * k, 0.005 * (k + 0.5), 0);
  x.emplace_back(0.3, 5, 0);  // spray does not count
  ASSERT_TRUE(world.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  const Box all = {Vec3::Constant(-10), Vec3::Constant(10)}, left = {Vec3::Constant(-10), Vec3(0.99, 10, 10)};
  EXPECT_NEAR(level_within(world, all), 0.005 * 99, 1e-12);
  EXPECT_DOUBLE_EQ(mass_within(world, all), 101 * world.particle_mass());
  EXPECT_DOUBLE_EQ(mass_within(world, left), 51 * world.particle_mass());
  EXPECT_FALSE(std::isfinite(level_within(world, {Vec3::Constant(-3), Vec3::Constant(-2)})));
  EXPECT_DOUBLE_EQ(depth_of(world, 6, 0.06), 0.1);
}

}  // namespace
}  // namespace oilskin::demo
