// The surface of a pool in a tank is level: water that the gap to the walls and the floor takes away is no
// rim along the walls, and its corners do not flicker.
#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruction/column.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::WaterScene;

constexpr double width = 20;  // [dx]

/// Water at rest in an open tank, z up.
WaterScene pool(int depth, double jitter) {
  WaterScene s;
  const double dx = s.spacing, half = 0.5 * width * dx, height = 1.5 * depth * dx;
  s.add_sheet(1, [&](double u, double v) { return Vec3((2 * u - 1) * half, (2 * v - 1) * half, 0); });
  for (const double side : {-half, half}) {
    s.add_sheet(1, [&](double u, double v) { return Vec3(side, (2 * u - 1) * half, v * height); });
    s.add_sheet(1, [&](double u, double v) { return Vec3((2 * u - 1) * half, side, v * height); });
  }
  s.add_water({Vec3(-half, -half, 0), Vec3(half, half, depth * dx)}, jitter, 7);
  s.push_off(0.4);
  return s;
}

struct Heights {
  double middle = 0;  ///< mean [dx]
  double rim = 0;     ///< the largest within 3 dx of a wall [dx]
};

Heights heights_of(const WaterMesh& mesh, double depth, double dx) {
  Heights h;
  double sum = 0, count = 0;
  for (const auto& v : mesh.positions) {
    const double z = double(v[2]) / dx;
    const double from_middle = double(std::max(std::abs(v[0]), std::abs(v[1]))) / dx;
    if (from_middle > 0.5 * width - 3) h.rim = std::max(h.rim, z);
    if (from_middle < 0.25 * width && z > 0.5 * depth) {
      sum += z;
      ++count;
    }
  }
  h.middle = sum / count;
  return h;
}

struct Case {
  double cell;
  double jitter;  ///< of the particles about a lattice
  double most;    ///< a rim is not higher [dx]; one over particles that are higher, in corners, is
};

class Pool : public ::testing::TestWithParam<Case> {};

TEST_P(Pool, is_level) {
  for (const int depth : {8, 24})
    for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
      const WaterScene s = pool(depth, GetParam().jitter);
      const ReconstructionOptions options = test::options_for(s, GetParam().cell, 0.1, mode);
      ReconstructionReport report;
      const WaterMesh mesh = test::reconstruct(s.input(), options, &report);
      const Heights h = heights_of(mesh, depth, s.spacing);
      const std::string name = "depth " + std::to_string(depth) + ", mode " + std::to_string(int(mode));
      test::record("rim over the middle [dx], " + name, h.rim - h.middle);
      test::record("middle over the water [dx], " + name, h.middle - depth);
      test::record("volume over water, " + name, test::share_of(report, s));
      EXPECT_LT(h.rim - h.middle, GetParam().most) << name;
      // The mesh has the gap to five sides less, and rises by 0.6 dx at most.
      EXPECT_NEAR(h.middle, depth + 0.3, 0.35) << name;
      EXPECT_NEAR(test::share_of(report, s), 0.975, 0.03) << name;
      test::expect_promise(s, mesh, options.gap);
    }
}

INSTANTIATE_TEST_SUITE_P(Cells, Pool,
                         ::testing::Values(Case{0.5, 0.15, 0.6}, Case{0.8, 0.15, 0.6}, Case{0.5, 0.3, 1},
                                           Case{0.8, 0.3, 1}));

/// Height of the surface over a point of the floor. A little beside it, since vertices lie over lines of the
/// grid.
double top_at(const WaterScene& s, const WaterMesh& mesh, double x, double y) {
  const Vec3 aside = 0.0137 * s.spacing * Vec3(1, 0.7, 0);
  return test::column_over(mesh, Vec3(x, y, 0) + aside, Vec3::UnitZ(), 3 * s.spacing).high;
}

/// Columns over one wall of a corner do not hold the water at the other. Where they counted as films, and
/// where vertices too near to a wall went back to their start, the surface rose and fell by up to 0.8 dx,
/// 0.03 to 0.05 dx on average, when particles moved by a fiftieth of dx.
TEST(PoolCorner, does_not_flicker) {
  for (const double jitter : {0.15, 0.3})
    for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
      WaterScene s = pool(10, jitter);
      const double dx = s.spacing;
      const ReconstructionOptions options = test::options_for(s, 0.8, 0.1, mode);
      test::Random random(5);
      std::vector<double> before;
      double sum = 0, count = 0;
      for (int frame = 0; frame < 4; ++frame) {
        const WaterMesh mesh = test::reconstruct(s.input(), options);
        std::vector<double> heights;
        for (const double side_x : {-1.0, 1.0})
          for (const double side_y : {-1.0, 1.0})
            for (const double x : {0.8, 1.3, 1.8, 2.3})
              for (const double y : {0.8, 1.3, 1.8, 2.3})
                heights.push_back(
                    top_at(s, mesh, side_x * (0.5 * width - x) * dx, side_y * (0.5 * width - y) * dx));
        EXPECT_GT(*std::min_element(heights.begin(), heights.end()), 9 * dx);
        for (std::size_t k = 0; k < before.size(); ++k) {
          sum += std::abs(heights[k] - before[k]) / dx;
          ++count;
        }
        before = heights;
        for (Vec3& x : s.particles) x += 0.02 * dx * random.in_cube(1);
      }
      test::record(
          "mean change [dx], jitter " + std::to_string(jitter) + ", mode " + std::to_string(int(mode)),
          sum / count);
      EXPECT_LT(sum / count, 0.02) << jitter << ' ' << int(mode);
    }
}

/// Water of one layer over a step, beside water of five layers.
WaterScene pool_with_a_step() {
  WaterScene s;
  const double dx = s.spacing;
  const auto add = [&](const Vec3& corner, const Vec3& a, const Vec3& b) {
    s.add_sheet(4, [=](double u, double v) { return Vec3(dx * (corner + u * a + v * b)); });
  };
  const Vec3 corner(-13, -8, 0), along(26, 0, 0), across(0, 16, 0), up(0, 0, 10), middle(0, -8, 0);
  add(corner, along, across);
  for (const Vec3& side : {corner, Vec3(corner + across)}) add(side, along, up);
  for (const Vec3& side : {corner, Vec3(corner + along)}) add(side, across, up);
  add(middle + 0.4 * up, 0.5 * along, across);
  add(middle, across, 0.4 * up);
  test::Random random(3);
  for (int n = 0; n < 5 * 16 * 26; ++n) {
    const int i = n % 26, j = n / 26 % 16, k = n / 26 / 16;
    if (i < 13 || k == 4)
      s.particles.push_back(dx * (Vec3(i - 12.5, j - 7.5, k + 0.5) + random.in_cube(0.15)));
  }
  s.push_off(0.4);
  return s;
}

/// What the deep part lacks at its walls made the layer 0.3 to 0.35 dx thicker, but for frames in which a gap
/// at the step's edge parted the two.
TEST(PoolWithAStep, has_one_level) {
  const WaterScene s = pool_with_a_step();
  const double dx = s.spacing;
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch})
    for (const int smoothing : {0, 10}) {
      ReconstructionOptions options = test::options_for(s, 1, 0.1, mode);
      options.smoothing_iterations = smoothing;
      const WaterMesh mesh = test::reconstruct(s.input(), options);
      double layer = 0, deep = 0, count = 0;
      for (int x = 2; x < 11; ++x)
        for (int y = -5; y < 6; ++y) {
          layer += top_at(s, mesh, x * dx, y * dx) / dx;
          deep += top_at(s, mesh, -x * dx, y * dx) / dx;
          ++count;
        }
      const std::string name =
          "mode " + std::to_string(int(mode)) + ", smoothing " + std::to_string(smoothing);
      test::record("layer over deep water [dx], " + name, (layer - deep) / count);
      EXPECT_NEAR((layer - deep) / count, 0, 0.15) << name;
      EXPECT_NEAR(deep / count, 5.5, 0.3) << name;
    }
}

}  // namespace
}  // namespace oilskin
