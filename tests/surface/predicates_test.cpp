// Distances of triangles and lines of sight, against other routes.
#include <gtest/gtest.h>

#include "support/random.h"
#include "surface/field.h"
#include "surface/separation.h"
#include "surface/triangle_oracle.h"
#include "surface/visibility.h"

namespace oilskin::surface {
namespace {

using test::Random;

Corners random_triangle(Random& random, int kind) {
  const Vec3 at = random.in_cube(1);
  const double size = kind == 1 ? 100 : (kind == 2 ? 1e-4 : 1);
  Corners c = {at + size * random.in_cube(1), at + size * random.in_cube(1), at + size * random.in_cube(1)};
  if (kind == 3) c[2] = 0.5 * (c[0] + c[1]) + 1e-9 * random.in_cube(1);  // a sliver
  if (kind == 4) c[2] = c[1];                                            // a segment
  return c;
}

TEST(Separation, never_says_more_than_the_distance_and_hardly_less) {
  Random random(3);
  std::size_t meeting = 0, apart = 0, exactly = 0;
  for (int round = 0; round < 40000; ++round) {
    const Corners a = random_triangle(random, 0), b = random_triangle(random, int(random.below(5)));
    const double size = 1 + b[0].norm() + b[1].norm() + b[2].norm();
    const double distance = test::triangle_distance(a, b), certified = certified_distance(a, b);
    ASSERT_LE(certified, distance * (1 + 1e-12)) << round;
    EXPECT_GE(certified, distance * (1 - 1e-6) - 1e-12 * size) << round;
    exactly += certified >= distance * (1 - 1e-9) - 1e-14 * size;
    (distance == 0 ? meeting : apart)++;
    for (const double limit : {0.0, 0.5 * distance, 0.999999 * distance, 1.0000001 * distance, 2 * distance})
      EXPECT_EQ(certified_apart(a, b, limit), certified > limit) << round;
  }
  EXPECT_GT(meeting, 800u);
  EXPECT_GT(apart, 15000u);
  EXPECT_GT(exactly, 39900u);
}

TEST(Separation, triangles_that_touch_are_not_apart) {
  const Corners a = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  EXPECT_FALSE(certified_apart(a, {Vec3(1, 0, 0), Vec3(2, 1, 0), Vec3(2, -1, 1)}, 0));  // in a corner
  EXPECT_FALSE(
      certified_apart(a, {Vec3(0.2, 0.2, 0), Vec3(0.3, 0.2, 1), Vec3(0.2, 0.3, 1)}, 0));  // on the face
  EXPECT_FALSE(certified_apart(a, a, 0));
  EXPECT_FALSE(certified_apart(a, {Vec3(0.1, 0.1, 0), Vec3(0.2, 0.1, 0), Vec3(0.1, 0.2, 0)}, 0));  // within
  EXPECT_FALSE(
      certified_apart(a, {Vec3(0.2, 0.2, 0), Vec3(0.2, 0.2, 0), Vec3(0.2, 0.2, 0)}, 0));  // a point on it
  EXPECT_TRUE(certified_apart(a, {Vec3(0, 0, 1e-9), Vec3(1, 0, 1e-9), Vec3(0, 1, 1e-9)}, 0.9e-9));
}

TEST(Visibility, a_line_through_an_edge_or_a_corner_of_a_mesh_is_blocked) {
  Random random(5);
  for (int round = 0; round < 20000; ++round) {
    // A fan around a middle vertex; the line passes exactly through that vertex, or a point of a spoke.
    const int n = 3 + int(random.below(5));
    std::vector<Vec3> v = {random.in_cube(1)};
    for (int k = 0; k < n; ++k)
      v.push_back(v[0] +
                  Vec3(std::cos(6.283185 * k / n), std::sin(6.283185 * k / n), random.uniform(-0.3, 0.3)));
    const std::uint32_t spoke = 1 + random.below(std::uint32_t(n));
    const Vec3 middle = round % 2 ? v[0] : Vec3(0.5 * (v[0] + v[spoke]));
    const Vec3 along(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1);
    const Vec3 p = middle - along, q = middle + along;
    bool blocked = false;
    for (std::uint32_t k = 0; k < std::uint32_t(n); ++k) {
      const Triangle t = {0, 1 + k, 1 + (k + 1) % std::uint32_t(n)};
      blocked |= segment_touches(p, q, {v[t[0]], v[t[1]], v[t[2]]}, t);
    }
    ASSERT_TRUE(blocked) << round;
  }
}

TEST(Visibility, the_bits_of_a_block_agree_with_every_triangle_asked_by_itself) {
  Random random(6);
  std::size_t hidden = 0, seen = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<Vec3> v;
    std::vector<Triangle> triangles;
    const std::uint32_t n = 1 + random.below(150);
    for (std::uint32_t t = 0; t < n; ++t) {
      const Vec3 at = Vec3::Constant(4) + random.in_cube(7);
      for (int k = 0; k < 3; ++k) v.push_back(at + random.in_cube(random.below(10) == 0 ? 40 : 1.5));
      triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const std::vector<ObstacleMesh> meshes = {{v, triangles}};
    const Obstacles obstacles(meshes);
    std::vector<std::uint32_t> all(n);
    for (std::uint32_t t = 0; t < n; ++t) all[t] = t;
    BlockSight sight;
    sight.set(obstacles, all, Vec3::Zero(), 1, 4);
    Words front_p, back_p, front_q, back_q, open(sight.words());
    std::uint32_t last = none;
    for (int pair = 0; pair < 300; ++pair) {
      std::array<float, 3> p, q, low, high;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = float(random.below(8));
        q[k] = float(p[k] + random.uniform(-4, 4));
        low[k] = std::min(p[k], q[k]);
        high[k] = std::max(p[k], q[k]);
      }
      for (Words* w : {&front_p, &back_p, &front_q, &back_q}) w->clear();
      sight.add_sides(&p, 1, front_p, back_p);
      sight.add_sides(&q, 1, front_q, back_q);
      const bool blocked = sight.may_hide(front_p.data(), back_p.data(), front_q.data(), back_q.data(), low,
                                          high, open.data()) &&
                           sight.hides(p, q, open.data(), last);
      bool expected = false;
      for (std::uint32_t t = 0; t < n; ++t)
        expected |= segment_touches(Vec3(p[0], p[1], p[2]), Vec3(q[0], q[1], q[2]), obstacles.corners(t),
                                    triangles[t]);
      ASSERT_EQ(blocked, expected) << round << " " << pair;
      (blocked ? hidden : seen)++;
    }
  }
  EXPECT_GT(hidden, 2000u);
  EXPECT_GT(seen, 2000u);
}

TEST(Eigenvalue, the_largest_root_is_one_and_none_is_larger) {
  Random random(8);
  for (int round = 0; round < 5000; ++round) {
    Eigen::Matrix3d a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.uniform(-1, 1);
    if (round % 3 == 0) a = a * a.transpose().eval();
    const double largest = largest_real_eigenvalue(a);
    EXPECT_NEAR((a - largest * Eigen::Matrix3d::Identity()).determinant(), 0, 1e-6);
    EXPECT_GT(((largest + 1e-3) * Eigen::Matrix3d::Identity() - a).determinant(), -1e-9);
  }
  EXPECT_DOUBLE_EQ(largest_real_eigenvalue(2 * Eigen::Matrix3d::Identity()), 2);
}

}  // namespace
}  // namespace oilskin::surface
