// Distances of triangles and lines of sight, against other routes.
#include <gtest/gtest.h>

#include "core/closest_point.h"
#include "reconstruction/field.h"
#include "reconstruction/obstacle_distance.h"
#include "reconstruction/triangle_distance.h"
#include "reconstruction/triangle_oracle.h"
#include "reconstruction/visibility.h"
#include "support/random.h"

namespace oilskin::reconstruction {
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

TEST(Separation, a_prism_is_never_farther_than_its_triangle_and_knows_when_it_is_as_far) {
  Random random(11);
  std::size_t exact = 0, apart = 0;
  double kept = 0;
  for (int round = 0; round < 40000; ++round) {
    const int kind = int(random.below(5));
    const Corners a = random_triangle(random, kind), b = random_triangle(random, round % 2 ? 2 : 0);
    const double size = 1 + a[0].norm() + a[1].norm() + a[2].norm();
    const double distance = test::triangle_distance(a, b);
    const TrianglePrism::Distance d = TrianglePrism(a).distance_from(b);
    ASSERT_LE(d.lower_bound, distance * (1 + 1e-12)) << round;
    ASSERT_GE(d.lower_bound, 0) << round;
    if (distance > 0 && kind < 3) {
      ++apart;
      kept += d.lower_bound / distance;
    }
    if (!d.is_exact) continue;
    ++exact;
    EXPECT_GE(d.lower_bound, distance * (1 - 1e-6) - 1e-12 * size) << round << " of kind " << kind;
  }
  EXPECT_GT(exact, 2000u);
  EXPECT_GT(apart, 15000u);
  EXPECT_GT(kept, 0.6 * double(apart));
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
      blocked |= hides_segment(p, q, {v[t[0]], v[t[1]], v[t[2]]}, t);
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
    BlockVisibility visibility;
    visibility.set(obstacles, all, Vec3::Zero(), 1, 4);
    Words front_p, back_p, front_q, back_q, open(visibility.words());
    std::uint32_t last = none;
    for (int pair = 0; pair < 300; ++pair) {
      std::array<float, 3> p, q, low, high;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = float(random.below(8));
        q[k] = float(p[k] + random.uniform(-4, 4));
        low[k] = std::min(p[k], q[k]);
        high[k] = std::max(p[k], q[k]);
      }
      visibility.sides(p, front_p, back_p);
      visibility.sides(q, front_q, back_q);
      const bool blocked = visibility.may_hide(front_p.data(), back_p.data(), front_q.data(), back_q.data(),
                                               low, high, open.data()) &&
                           visibility.hides(p, q, open.data(), last);
      bool expected = false;
      for (std::uint32_t t = 0; t < n; ++t)
        expected |=
            hides_segment(Vec3(p[0], p[1], p[2]), Vec3(q[0], q[1], q[2]), obstacles.corners(t), triangles[t]);
      ASSERT_EQ(blocked, expected) << round << " " << pair;
      (blocked ? hidden : seen)++;
    }
  }
  EXPECT_GT(hidden, 2000u);
  EXPECT_GT(seen, 2000u);
}

/// Around a block of 8³: small and large ones, slivers, and some that share a corner.
Obstacles random_triangles(Random& random, std::uint32_t count) {
  std::vector<Vec3> v;
  std::vector<Triangle> t;
  for (std::uint32_t k = 0; k < count; ++k) {
    const int kind = int(random.below(10));
    const double size = kind == 0 ? 1e5 : (kind == 1 ? 40 : (kind == 2 ? 0.05 : 2));
    const Vec3 at = Vec3::Constant(4) + random.in_cube(7);
    const auto first = static_cast<std::uint32_t>(v.size());
    v.push_back(kind == 3 && first > 0 ? v[random.below(first)] : at);
    v.push_back(at + size * random.in_cube(1));
    v.push_back(kind == 4 ? Vec3(0.5 * (v[first] + v[first + 1]) + 1e-7 * random.in_cube(1))
                          : Vec3(at + size * random.in_cube(1)));
    if (kind == 5)  // in a plane of the grid
      for (std::uint32_t n = first; n < first + 3; ++n) v[n].y() = 3;
    t.push_back({first, first + 1, first + 2});
  }
  const std::vector<ObstacleMesh> meshes = {{v, t}};
  return Obstacles(meshes);
}

TEST(Visibility, shadows_over_a_row_agree_with_every_node_asked_by_itself) {
  Random random(16);
  std::size_t hidden = 0, seen = 0;
  for (int round = 0; round < 150; ++round) {
    const std::uint32_t n = 1 + random.below(70);
    const Obstacles obstacles = random_triangles(random, n);
    std::vector<std::uint32_t> all(n);
    for (std::uint32_t t = 0; t < n; ++t) all[t] = t;
    BlockVisibility visibility;
    visibility.set(obstacles, all, Vec3::Zero(), 1, 4);
    const Words open(visibility.words(), ~0ull);
    Shadows shadows;
    for (int particle = 0; particle < 20; ++particle) {
      std::array<float, 3> p;
      for (float& x : p) x = static_cast<float>(random.uniform(-4, 12));
      if (particle % 4 == 0) p[1] = 3;  // in the plane of some triangles
      shadows.set(visibility, p);
      const int j = int(random.below(8)), k = int(random.below(8));
      const std::uint32_t wanted = random.below(256);
      std::uint32_t expected = 0;
      for (int i = 0; i < side; ++i)
        for (std::uint32_t t = 0; t < n; ++t)
          if (hides_segment(Vec3(i, j, k), Vec3(p[0], p[1], p[2]), obstacles.corners(t),
                            obstacles.indices(t)))
            expected |= 1u << i;
      ASSERT_EQ(shadows.hidden(j, k, wanted, open.data()), expected & wanted) << round << " " << particle;
      (expected != 0 ? hidden : seen)++;
    }
  }
  EXPECT_GT(hidden, 500u);
  EXPECT_GT(seen, 500u);
}

TEST(Distances, of_nodes_are_those_of_the_closest_triangle) {
  Random random(17);
  std::size_t within = 0, beyond = 0;
  for (int round = 0; round < 120; ++round) {
    const std::uint32_t n = 1 + random.below(40);
    const Obstacles obstacles = random_triangles(random, n);
    NearBlock near;
    for (std::uint32_t t = 0; t < n; ++t) near.triangles.push_back(t);
    const double band = random.uniform(0.5, 3);
    measure_obstacles(obstacles, Vec3::Zero(), 1, band, false, near);
    for (int node = 0; node < nodes; ++node) {
      const Vec3 x(node & 7, node >> 3 & 7, node >> 6);
      double minimum = std::numeric_limits<double>::infinity();
      for (std::uint32_t t = 0; t < n; ++t) {
        const Corners c = obstacles.corners(t);
        minimum = std::min(minimum, closest_point(x, c[0], c[1], c[2]).distance);
      }
      const double measured =
          near.distance.empty() ? std::numeric_limits<double>::infinity() : near.distance[std::size_t(node)];
      if (minimum <= band) {
        ASSERT_NEAR(measured, minimum, 1e-6) << round << " " << node;
        ++within;
      } else {
        ASSERT_TRUE(std::isinf(measured)) << round << " " << node;
        ++beyond;
      }
    }
  }
  EXPECT_GT(within, 5000u);
  EXPECT_GT(beyond, 5000u);
}

TEST(Eigenvalue, the_largest_root_is_one_and_none_is_larger) {
  Random random(8);
  for (int round = 0; round < 5000; ++round) {
    Eigen::Matrix3d a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.uniform(-1, 1);
    if (round % 3 == 0) a = a * a.transpose().eval();
    const double largest = max_real_eigenvalue(a);
    EXPECT_NEAR((a - largest * Eigen::Matrix3d::Identity()).determinant(), 0, 1e-6);
    EXPECT_GT(((largest + 1e-3) * Eigen::Matrix3d::Identity() - a).determinant(), -1e-9);
  }
  EXPECT_DOUBLE_EQ(max_real_eigenvalue(2 * Eigen::Matrix3d::Identity()), 2);
}

}  // namespace
}  // namespace oilskin::reconstruction
