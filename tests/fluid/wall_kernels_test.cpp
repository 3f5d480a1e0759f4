// The loops over particles and triangles: what they find, and all versions that this machine has against each
// other.
#include "fluid/pairs/wall_kernels.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/closest_point.h"
#include "fluid/boundary/visible_part.h"
#include "fluid/boundary/wall_integral.h"
#include "support/random.h"
#include "using_instruction_set.h"

namespace oilskin::fluid {
namespace {

/// Triangles around the origin, every fifth without area.
std::vector<Corners> random_triangles(std::size_t count, unsigned seed) {
  test::Random random(seed);
  std::vector<Corners> all(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 a = random.in_cube(1), b = a + random.in_cube(0.5);
    const Vec3 c = k % 10 == 4 ? b : k % 10 == 9 ? Vec3(a + 0.3 * (b - a)) : Vec3(a + random.in_cube(0.5));
    const Vec3 corner[] = {a, b, c};
    for (std::size_t n = 0; n < 9; ++n) all[k].x[n] = corner[n / 3][static_cast<int>(n % 3)];
  }
  return all;
}

std::vector<ClosestBlock> closest_with(InstructionSet set, const std::vector<Corners>& triangles,
                                       std::size_t count, const Vec3& p) {
  const Using chosen(set);
  std::vector<std::uint32_t> index((count + 3) / 4 * 4, 0);
  for (std::size_t k = 0; k < count; ++k) index[k] = static_cast<std::uint32_t>(triangles.size() - 1 - k);
  std::vector<ClosestBlock> blocks((count + 3) / 4);
  pair_kernels().closest(triangles.data(), index.data(), count, p.data(), blocks.data());
  return blocks;
}

TEST(WallKernels, closest_points_are_those_of_single_triangles) {
  const std::vector<Corners> triangles = random_triangles(400, 1);
  test::Random random(2);
  for (const InstructionSet set : all_instruction_sets) {
    if (!is_available(set)) continue;
    for (const std::size_t count : {1, 3, 4, 5, 400}) {
      const Vec3 p = random.in_cube(1);
      const auto blocks = closest_with(set, triangles, count, p);
      for (std::size_t k = 0; k < count; ++k) {
        const double* x = triangles[triangles.size() - 1 - k].x;
        const Vec3 a(x[0], x[1], x[2]), b(x[3], x[4], x[5]), c(x[6], x[7], x[8]);
        const ClosestPoint expected = closest_point(p, a, b, c);
        const ClosestBlock& found = blocks[k / 4];
        EXPECT_NEAR(found.distance[k % 4], expected.distance, 1e-14);
        for (std::size_t n = 0; n < 3; ++n) {
          EXPECT_NEAR(found.weight[n][k % 4], expected.weights[n], 1e-12);
          EXPECT_EQ(found.weight[n][k % 4] == 0, expected.weights[n] == 0) << "the feature";
          EXPECT_NEAR(found.offset[n][k % 4], expected.offset[static_cast<int>(n)], 1e-14);
        }
        const Vec3 cross = (b - a).cross(c - a);
        if (!(cross.norm() > 1e-3)) continue;
        const double height = cross.normalized().dot(p - a);
        EXPECT_NEAR(found.height2[k % 4], height * height, 1e-11);
      }
    }
  }
}

TEST(WallKernels, closest_points_have_the_same_bits_for_all_instruction_sets) {
  if (others().empty()) GTEST_SKIP() << "only the baseline";
  const std::vector<Corners> triangles = random_triangles(2000, 3);
  const Vec3 p(0.1, -0.05, 0.2);
  const auto a = closest_with(InstructionSet::baseline, triangles, 2000, p);
  for (const InstructionSet set : others()) {
    const auto b = closest_with(set, triangles, 2000, p);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(std::memcmp(&a[k], &b[k], sizeof a[k]), 0) << k;
  }
}

std::array<Eigen::Vector3f, 3> random_corners(test::Random& random) {
  const Vec3 center = random.uniform(0.05, 0.9) * random.direction();
  std::array<Eigen::Vector3f, 3> corners;
  for (Eigen::Vector3f& x : corners)
    x = (center + random.uniform(0.01, 0.6) * random.direction()).cast<float>();
  return corners;
}

/// Visible parts with crowds of triangles: edges() and hide().
std::vector<WallView> views_with(InstructionSet set) {
  const Using chosen(set);
  test::Random random(4);
  std::vector<WallView> all;
  VisibleParts parts;
  for (std::size_t count = 1; count < 40; ++count) {
    parts.clear();
    for (std::size_t k = 0; k < count; ++k) parts.add(random_corners(random));
    const auto& views = parts.views([](std::size_t k) { return k % 7 != 5; });
    all.insert(all.end(), views.begin(), views.end());
  }
  return all;
}

TEST(WallKernels, visible_parts_have_the_same_bits_for_all_instruction_sets) {
  if (others().empty()) GTEST_SKIP() << "only the baseline";
  const auto a = views_with(InstructionSet::baseline);
  std::size_t partly = 0;
  for (const WallView& view : a) partly += view.share > 0;
  EXPECT_GT(partly, 100u);
  for (const InstructionSet set : others()) {
    const auto b = views_with(set);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_EQ(bits(static_cast<double>(a[k].share)), bits(static_cast<double>(b[k].share))) << k;
  }
}

/// Of one edge: the sum over an edge cut in two must be that of the whole, for edges in all places.
TEST(WallKernels, an_edge_is_the_sum_of_its_parts) {
  test::Random random(6);
  int crossing = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const auto corners = random_corners(random);
    const WallPlane plane(corners);
    if (!plane.acts() || plane.distance() < 0.2f) continue;  // nearer ones need more nodes
    const float cut = static_cast<float>(random.uniform());
    const Eigen::Vector3f middle = corners[0] + cut * (corners[1] - corners[0]);
    const Eigen::Vector3f with_middle[] = {corners[0], middle, corners[1], corners[2]};
    Shadows shadows;
    shadows.add(plane, {corners.data(), 3});
    shadows.add(plane, {with_middle, 4});
    shadows.integrate();
    EXPECT_NEAR(shadows[0], shadows[1], 2e-4) << "trial " << trial;
    crossing += shadows[0] > 1e-3f;
  }
  EXPECT_GT(crossing, 100);
}

/// Spheres and planes at random.
struct Spheres {
  std::vector<float> column[8];
  std::vector<std::uint32_t> number;
  explicit Spheres(std::size_t count) {
    test::Random random(7);
    for (auto& c : column) c.resize(count + 8);
    number.resize(count + 16);
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 center = random.in_cube(2), normal = random.direction();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        column[axis][k] = static_cast<float>(center[static_cast<int>(axis)]);
        column[4 + axis][k] = static_cast<float>(normal[static_cast<int>(axis)]);
      }
      column[3][k] = static_cast<float>(random.uniform(0.2, 3));
      column[7][k] = static_cast<float>(normal.dot(center));
      number[k] = static_cast<std::uint32_t>(3 * k + 1);
    }
    for (std::size_t k = count; k < count + 8; ++k) column[3][k] = -1;
  }
  TriangleColumns columns(std::size_t count) const {
    return {column[0].data(), column[1].data(), column[2].data(), column[3].data(), column[4].data(),
            column[5].data(), column[6].data(), column[7].data(), number.data(),    count};
  }
  /// In double, except where rounding decides.
  bool touches(std::size_t k, const Vec3& p, double reach, bool* is_sure) const {
    const Vec3 center(column[0][k], column[1][k], column[2][k]),
        normal(column[4][k], column[5][k], column[6][k]);
    const double radius2 = static_cast<double>(column[3][k]), distance2 = (center - p).squaredNorm();
    const double height = std::abs(normal.dot(p) - static_cast<double>(column[7][k]));
    *is_sure = std::abs(distance2 - radius2) > 1e-5 && std::abs(height - reach) > 1e-5;
    return distance2 <= radius2 && height <= reach;
  }
};

TEST(WallKernels, find_the_triangles_that_touch_in_their_order) {
  test::Random random(8);
  std::size_t hits = 0;
  for (const InstructionSet set : all_instruction_sets) {
    if (!is_available(set)) continue;
    const Using chosen(set);
    for (std::size_t count = 0; count < 200; count += count < 20 ? 1 : 37) {
      const Spheres spheres(count);
      const Vec3 place = random.in_cube(1).cast<float>().cast<double>();
      const Eigen::Vector3f p = place.cast<float>();
      std::vector<std::uint32_t> found(count + 8), expected;
      found.resize(pair_kernels().touching(spheres.columns(count), p.data(), 0.5f, found.data()));
      bool is_sure = true;
      for (std::size_t k = 0; k < count && is_sure; ++k)
        if (spheres.touches(k, place, 0.5, &is_sure)) expected.push_back(spheres.number[k]);
      if (!is_sure) continue;
      EXPECT_EQ(found, expected) << count;
      hits += expected.size();
    }
  }
  EXPECT_GT(hits, 50u);
}

}  // namespace
}  // namespace oilskin::fluid
