// The surface of a pool in a tank is level: water that the gap to the walls and the floor takes away is no
// rim along the walls.
#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruction/promise.h"
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

}  // namespace
}  // namespace oilskin
