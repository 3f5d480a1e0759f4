// Films between obstacles that face each other, in bends and in tubes.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/promise.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::position;
using test::WaterScene;

/// Of the spacing.
constexpr double gap = 0.1;

TEST(FilmInATrough, keeps_its_volume) {
  for (const double radius : {2.5, 3.0, 3.25})
    for (const double cell : {0.5, 0.8, 0.9}) {
      WaterScene s;
      const double dx = s.spacing, pi = 3.14159265358979;
      const auto on_arc = [&](double r, double along, double y) {
        const double angle = pi * (along - 0.5);
        return Vec3(r * std::sin(angle) * dx, y * dx, (radius - r * std::cos(angle)) * dx);
      };
      s.add_sheet(40, [&](double u, double v) { return on_arc(radius, u, 32 * v - 16); });
      test::Random random(4);
      const int around = static_cast<int>(0.8 * pi * (radius - 0.5));
      for (int n = 0; n < 24 * around; ++n)
        s.particles.push_back(
            on_arc(radius - 0.5, 0.1 + 0.8 * (n % around + 0.5) / around, n / around - 11.5) +
            0.05 * dx * random.in_cube(1));
      ReconstructionReport report;
      test::reconstruct(s.input(), test::options_for(s, cell, gap, ObstacleMode::gap), &report);
      EXPECT_NEAR(test::share_of(report, s), 1, 0.03) << radius << ' ' << cell;
    }
}

/// The flanks of a valley face each other at an angle, and see each other's edges. Where such edges counted,
/// films had up to 1.5 times their volume there.
TEST(FilmInAValley, keeps_its_volume) {
  for (const auto& [length, amplitude] : {std::pair{9.0, 2.0}, std::pair{14.0, 3.0}})
    for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch})
      for (const double cell : {0.5, 0.8, 1.0}) {
        WaterScene s;
        const double dx = s.spacing, wave = 6.28318530717959 / length, half = 14, between = 1.8;
        const double steep = amplitude * wave;
        const auto place = [&](double x, double y, double above) {
          const Vec3 normal = Vec3(-steep * std::cos(wave * x), 0, 1).normalized();
          return Vec3(dx * (Vec3(x, y, amplitude * std::sin(wave * x)) + above * normal));
        };
        s.add_sheet(100, [&](double u, double v) { return place(32 * u - 16, 32 * v - 16, 0); });
        test::Random random(7);
        // Even along the slope.
        for (double x = -half; x < half; x += between / std::hypot(1, steep * std::cos(wave * x)))
          for (double y = -half; y < half; y += between)
            s.particles.push_back(place(x, y + 0.5 * random.uniform(0, 1), random.uniform(0.25, 0.5)));
        ReconstructionReport report;
        test::reconstruct(s.input(), test::options_for(s, cell, gap, mode), &report);
        EXPECT_NEAR(test::share_of(report, s), 1, 0.05) << length << ' ' << int(mode) << ' ' << cell;
      }
}

/// Layers of water between two wavy sheets, in spacings.
struct Between {
  const char* name;
  double width;   ///< from one sheet to the other
  double height;  ///< of the lowest layer over the lower sheet
  int layers;
};

std::string name_of(const testing::TestParamInfo<Between>& info) {
  return info.param.name;
}

class FilmBetween : public testing::TestWithParam<Between> {
 protected:
  static constexpr int side = 24;

  static WaterScene scene() {
    WaterScene s;
    const double dx = s.spacing;
    const auto wave = [&](double x) { return test::waves(x, 0, dx, 12 * dx); };
    for (const double height : {0.0, GetParam().width})
      s.add_sheet(40, [&](double u, double v) {
        const double x = 1.5 * side * dx * (u - 0.5), y = 1.5 * side * dx * (v - 0.5);
        return Vec3(x, y, wave(x) + height * dx);
      });
    test::Random random(3);
    for (int layer = 0; layer < GetParam().layers; ++layer)
      for (int n = 0; n < side * side; ++n) {
        const Vec3 at(n % side + 0.5 - side / 2, n / side + 0.5 - side / 2, GetParam().height + layer);
        const Vec3 p = dx * (at + random.in_cube(0.15));
        s.particles.push_back(p + wave(p.x()) * Vec3::UnitZ());
      }
    return s;
  }
};

/// Where the particles of both entries counted, it was 1.4 to 2.2 times as thick.
TEST_P(FilmBetween, two_sheets_has_its_thickness_at_the_vertices) {
  const WaterScene s = scene();
  const double layers = GetParam().layers * s.spacing, inner = 0.3 * side * s.spacing;
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
    const WaterMesh mesh = test::reconstruct(s.input(), test::options_for(s, 0.5, gap, mode));
    // Along the normal layers are thinner: the mean of its z is 0.94.
    double sum = 0, count = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 x = position(mesh, std::uint32_t(v));
      if (std::abs(x.x()) > inner || std::abs(x.y()) > inner) continue;
      sum += double(mesh.thickness[v]);
      ++count;
    }
    ASSERT_GT(count, 100);
    test::record("thickness over layers, mode " + std::to_string(int(mode)), sum / count / layers);
    EXPECT_NEAR(sum / count / layers, 0.94, 0.06) << int(mode);
  }
}

/// Each sheet has its own film where the grid has space for both: they were one in the middle.
TEST(FilmsBetween, two_sheets_lie_on_their_sheets) {
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch})
    for (const double width : {3.0, 3.3}) {
      WaterScene s;
      const double dx = s.spacing;
      for (const double z : {0.0, width})
        s.add_sheet(20, [&](double u, double v) { return Vec3(40 * dx * u, 40 * dx * v, dx * z); });
      test::Random random(8);
      for (int n = 0; n < 2 * 24 * 24; ++n) {
        const double above = random.uniform(0.2, 0.6);
        s.particles.push_back(
            dx * (Vec3(8 + n / 2 % 24, 8 + n / 48, n % 2 ? width - above : above) + random.in_cube(0.1)));
      }
      ReconstructionReport report;
      const WaterMesh mesh = test::reconstruct(s.input(), test::options_for(s, 0.5, gap, mode), &report);
      EXPECT_NEAR(test::share_of(report, s), 1, 0.01);
      std::size_t lower = 0, upper = 0, between = 0;
      float thickest = 0;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Vec3 x = position(mesh, std::uint32_t(v)) / dx;
        if (std::min(x.x(), x.y()) < 10 || std::max(x.x(), x.y()) > 30) continue;  // rims
        thickest = std::max(thickest, mesh.thickness[v]);
        ++(x.z() < 1.4 ? lower : x.z() > width - 1.4 ? upper : between);
      }
      EXPECT_LT(double(thickest), 1.2 * dx) << "the other film does not count";
      EXPECT_GT(lower, 3000u) << int(mode) << ' ' << width;
      EXPECT_GT(upper, 3000u) << int(mode) << ' ' << width;
      EXPECT_EQ(between, 0u) << int(mode) << ' ' << width;
    }
}

/// In a tube no column over its wall holds the water across it.
TEST(FilmInATube, fills_it) {
  for (const auto& [radius, mode] : {std::pair{1.25, ObstacleMode::touch}, std::pair{1.5, ObstacleMode::gap},
                                     std::pair{1.5, ObstacleMode::touch}}) {
    WaterScene s;
    const double dx = s.spacing, pi = 3.14159265358979;
    s.add_sheet(24, [&](double u, double v) {
      const double angle = 2 * pi * u;
      return Vec3(radius * dx * std::cos(angle), (30 * v - 15) * dx, radius * dx * std::sin(angle));
    });
    // 0.9 of the space that the gap leaves.
    const double free = radius - 0.1 - 0.15 * 0.5, length = 20;
    const int count = static_cast<int>(0.9 * pi * free * free * length);
    test::Random random(6);
    while (int(s.particles.size()) < count) {
      const Vec3 p(random.uniform(-1, 1) * free, random.uniform(-0.5, 0.5) * length,
                   random.uniform(-1, 1) * free);
      if (p.x() * p.x() + p.z() * p.z() < (radius - 0.3) * (radius - 0.3)) s.particles.push_back(dx * p);
    }
    ReconstructionReport report;
    test::reconstruct(s.input(), test::options_for(s, 0.5, gap, mode), &report);
    test::record(
        "volume over water, radius " + std::to_string(radius) + ", mode " + std::to_string(int(mode)),
        test::share_of(report, s));
    EXPECT_NEAR(test::share_of(report, s), 1, 0.1) << radius << ' ' << int(mode);
  }
}

TEST_P(FilmBetween, two_sheets_has_its_volume) {
  const WaterScene s = scene();
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch})
    for (const double cell : {0.5, 0.8, 1.0}) {
      const ReconstructionOptions options = test::options_for(s, cell, gap, mode);
      ReconstructionReport report;
      const WaterMesh mesh = test::reconstruct(s.input(), options, &report);
      test::record("volume over water, mode " + std::to_string(int(mode)) + ", cell " + std::to_string(cell),
                   test::share_of(report, s));
      EXPECT_NEAR(test::share_of(report, s), 1, 0.05) << int(mode) << ' ' << cell;
      test::expect_promise(s, mesh, options.gap);
    }
}

INSTANTIATE_TEST_SUITE_P(Layers, FilmBetween,
                         testing::Values(Between{"at_one_of_two_sheets", 2, 0.5, 1},
                                         Between{"in_the_middle", 2, 1, 1},
                                         Between{"in_the_middle_of_wide_space", 2.5, 1.25, 1},
                                         Between{"two_layers_fill_the_space", 2.5, 0.75, 2},
                                         Between{"two_layers_at_one_sheet", 3, 0.5, 2}),
                         name_of);

}  // namespace
}  // namespace oilskin
