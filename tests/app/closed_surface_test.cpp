// What is inside of a closed cloth, on shapes whose answers are known.
#include "geometry/closed_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/obj_reader.h"

namespace oilskin::demo {
namespace {

SurfaceMotion surface_of(const Mesh& mesh) {
  SurfaceMotion motion;
  motion.x_t1 = mesh.vertices;
  motion.triangles = mesh.triangles;
  return motion;
}

constexpr double radius = 0.08;

SurfaceMotion bag() {
  return surface_of(read_obj_file(OILSKIN_SCENES "/bag.obj"));
}

TEST(ClosedSurface, a_ball_holds_what_is_nearer_than_its_radius) {
  const SurfaceMotion motion = bag();
  const ClosedSurface ball(motion);
  EXPECT_TRUE(ball.closed());
  constexpr double pi = 3.14159265358979323846;
  EXPECT_NEAR(ball.volume() / (4 * pi / 3 * std::pow(radius, 3)), 1, 0.005);
  for (int i = 0; i < 4000; ++i) {
    const double a = 0.1 * i, r = radius * 1.5 * i / 4000;
    const Vec3 p = r * Vec3(std::cos(a) * std::sin(7 * a), std::sin(a) * std::sin(7 * a), std::cos(7 * a));
    if (r < 0.995 * radius || r > radius) {
      EXPECT_EQ(ball.winding_number(p), r < radius ? 1 : 0) << p.transpose();
    }
  }
}

// The line upwards passes through nodes and edges: each must count once, for the faces on one of its sides.
TEST(ClosedSurface, points_under_nodes_and_edges_are_inside) {
  const SurfaceMotion motion = bag();
  const ClosedSurface ball(motion);
  for (const Triangle& t : motion.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = motion.x_t1[t[k]], b = motion.x_t1[t[(k + 1) % 3]], middle = 0.5 * (a + b);
      for (const Vec3& x : {a, middle}) {
        if (std::hypot(x.x(), x.z()) > 0.9 * radius) continue;
        EXPECT_EQ(ball.winding_number(Vec3(x.x(), 0, x.z())), 1) << x.transpose();
        EXPECT_EQ(ball.winding_number(Vec3(x.x(), -2 * radius, x.z())), 0) << x.transpose();
      }
    }
  }
}

// A cloth that passes through itself: a number per region, the sum of both.
TEST(ClosedSurface, where_two_balls_overlap_the_number_is_two) {
  SurfaceMotion motion = bag();
  const std::size_t nodes = motion.x_t1.size(), faces = motion.triangles.size();
  for (std::size_t i = 0; i < nodes; ++i) motion.x_t1.push_back(motion.x_t1[i] + Vec3(radius, 0, 0));
  for (std::size_t t = 0; t < faces; ++t) {
    Triangle moved = motion.triangles[t];
    for (std::uint32_t& i : moved) i += static_cast<std::uint32_t>(nodes);
    motion.triangles.push_back(moved);
  }
  const ClosedSurface balls(motion);
  EXPECT_EQ(balls.winding_number(Vec3(0.5 * radius, 0.001, 0.002)), 2);
  EXPECT_EQ(balls.winding_number(Vec3(-0.5 * radius, 0.001, 0.002)), 1);
  EXPECT_EQ(balls.winding_number(Vec3(1.5 * radius, 0.001, 0.002)), 1);
}

TEST(ClosedSurface, turned_inside_out_it_counts_backwards) {
  SurfaceMotion motion = bag();
  for (Triangle& t : motion.triangles) std::swap(t[0], t[1]);
  const ClosedSurface ball(motion);
  EXPECT_TRUE(ball.closed());
  EXPECT_EQ(ball.winding_number(Vec3(0.01, 0.01, 0.01)), -1);
  EXPECT_LT(ball.volume(), 0);
}

TEST(ClosedSurface, a_missing_face_opens_it) {
  SurfaceMotion motion = bag();
  motion.triangles.pop_back();
  EXPECT_FALSE(ClosedSurface(motion).closed());
}

}  // namespace
}  // namespace oilskin::demo
