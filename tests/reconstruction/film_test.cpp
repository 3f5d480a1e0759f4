// Water that lies on a sheet in a layer: one sheet of water, as thick as the water there.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/column.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::Column;
using test::position;
using test::WaterScene;

constexpr double slope_x = 0.31, slope_y = 0.17;
const Vec3 normal = Vec3(-slope_x, -slope_y, 1).normalized();

double height(double x, double y) {
  return slope_x * x + slope_y * y;
}

double above(const Vec3& x) {
  return normal.dot(x);
}

/// A tilted sheet of 12 × 12 cm, and particles `distance` spacings apart on its inner 8 × 8 cm.
WaterScene film(double distance, std::uint64_t seed, double side = 1) {
  WaterScene s;
  s.add_sheet(10, [](double u, double v) { return Vec3(0.12 * u, 0.12 * v, height(0.12 * u, 0.12 * v)); });
  test::Random random(seed);
  const double step = distance * s.spacing;
  const int count = static_cast<int>(std::ceil(0.08 / step));
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      const double x = 0.02 + step * (i + random.uniform(-0.2, 0.2)),
                   y = 0.02 + step * (j + random.uniform(-0.2, 0.2));
      s.particles.push_back(Vec3(x, y, height(x, y)) + side * random.uniform(0.2, 0.45) * s.spacing * normal);
    }
  return s;
}

ReconstructionOptions options_for(const WaterScene& s, double cell, ObstacleMode mode) {
  return test::options_for(s, cell, 0.1, mode);
}

/// Along the sheet's normal.
Column column_over(const WaterMesh& mesh, const Vec3& base) {
  return test::column_over(mesh, base, normal, 0.008);
}

/// The mean of the water per area around a point of the sheet, kernel radius three spacings.
double water_per_area(const WaterScene& s, const Vec3& base) {
  const double reach = 3 * s.spacing;
  double sum = 0;
  for (const Vec3& p : s.particles) {
    const Vec3 offset = p - base;
    const double q2 = (offset - normal.dot(offset) * normal).squaredNorm() / (reach * reach);
    if (q2 < 1) sum += std::pow(1 - q2, 3);
  }
  return sum * 4 / (3.14159265358979 * reach * reach) * std::pow(s.spacing, 3);
}

/// Is the film whole around a point, so that it is no edge?
bool is_whole_around(const WaterMesh& mesh, double x, double y, double reach) {
  for (int k = 0; k < 8; ++k) {
    const double px = x + reach * std::cos(0.7854 * k), py = y + reach * std::sin(0.7854 * k);
    if (!column_over(mesh, Vec3(px, py, height(px, py))).is_wet()) return false;
  }
  return true;
}

struct Survey {
  double covered = 0;    ///< share of the points
  double deviation = 0;  ///< rms of thickness over water per area − 1, away from edges
  double lowest = INFINITY;
};

Survey survey(const WaterScene& s, const WaterMesh& mesh) {
  Survey result;
  int wet = 0, points = 0, whole = 0;
  double squares = 0;
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 21; ++i, ++points) {
      const double x = 0.036 + 0.0023 * i, y = 0.036 + 0.0023 * j;
      const Vec3 base(x, y, height(x, y));
      const Column column = column_over(mesh, base);
      if (!column.is_wet()) continue;
      ++wet;
      result.lowest = std::min(result.lowest, column.low);
      if (!is_whole_around(mesh, x, y, s.spacing)) continue;
      ++whole;
      squares += std::pow(column.length / water_per_area(s, base) - 1, 2);
    }
  result.covered = double(wet) / points;
  result.deviation = std::sqrt(squares / whole);
  return result;
}

class Film : public testing::TestWithParam<double> {};

// Thicknesses of 0.87 to 0.16 spacings, more and less than a cell. At 2.5 spacings some particles are more
// than 3 apart, and few are in the reach of the mean.
TEST_P(Film, is_one_sheet_as_thick_as_the_water_there) {
  for (const double distance : {1.07, 1.2, 1.5, 2.0, 2.5}) {
    const WaterScene s = film(distance, 11);
    const ReconstructionOptions options = options_for(s, GetParam(), ObstacleMode::touch);
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    test::expect_promise(s, mesh, options.gap);
    const Survey found = survey(s, mesh);
    RecordProperty("covered_" + std::to_string(int(10 * distance)), std::to_string(found.covered));
    RecordProperty("deviation_" + std::to_string(int(10 * distance)), std::to_string(found.deviation));
    EXPECT_GT(found.covered, distance < 2.5 ? 0.99 : 0.95) << distance;
    const double most = distance < 2 ? (GetParam() < 0.8 ? 0.02 : 0.06) : (distance < 2.5 ? 0.1 : 0.2);
    EXPECT_LT(found.deviation, most) << distance;
    EXPECT_LT(found.lowest, (0.1 + 0.3 * GetParam()) * s.spacing) << "it lies on the sheet";
    const double volume = check_mesh(mesh, {}, 0).volume;
    EXPECT_NEAR(volume / (double(s.particles.size()) * std::pow(s.spacing, 3)), 1, 0.03) << distance;
  }
}

// Where a jet hits a sheet, one mesh has deep water and a film: each has its own volume.
TEST_P(Film, beside_deep_water_is_as_thick_as_without) {
  WaterScene s = film(1.07, 11);
  for (int k = 1; k < 8; ++k)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 4; ++i) {
        const double x = 0.02 + i * s.spacing, y = 0.02 + j * s.spacing;
        s.particles.push_back(Vec3(x, y, height(x, y)) + (0.3 + k) * s.spacing * normal);
      }
  const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, GetParam(), ObstacleMode::touch));
  double length = 0, water = 0;
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 11; ++i) {
      const double x = 0.06 + 0.0023 * i, y = 0.036 + 0.0023 * j;
      const Vec3 base(x, y, height(x, y));
      length += column_over(mesh, base).length;
      water += water_per_area(s, base);
    }
  test::record("thickness over water per area", length / water);
  EXPECT_NEAR(length / water, 1, 0.05);
}

TEST_P(Film, leaves_dry_what_is_far_from_all_particles) {
  const WaterScene s = film(2.2, 12);
  const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, GetParam(), ObstacleMode::touch));
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    double nearest = INFINITY;
    for (const Vec3& p : s.particles) nearest = std::min(nearest, (p - position(mesh, v)).norm());
    ASSERT_LT(nearest, 3 * s.spacing);
  }
}

TEST_P(Film, in_mode_gap_stays_where_the_particles_are) {
  const WaterScene s = film(2.0, 13);
  const ReconstructionOptions options = options_for(s, GetParam(), ObstacleMode::gap);
  const WaterMesh mesh = test::reconstruct(s.input(), options);
  test::expect_promise(s, mesh, options.gap);
  const Survey found = survey(s, mesh);
  EXPECT_GT(found.covered, 0.95);
  double mean = 0;
  int count = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v, ++count) mean += above(position(mesh, v));
  EXPECT_NEAR(mean / count, 0.325 * s.spacing, 0.12 * s.spacing) << "mean height of the particles";
}

TEST_P(Film, on_both_sides_of_a_sheet_is_two) {
  WaterScene s = film(1.8, 14);
  for (const Vec3& p : film(1.8, 15, -1).particles) s.particles.push_back(p);
  const ReconstructionOptions options = options_for(s, GetParam(), ObstacleMode::touch);
  const WaterMesh mesh = test::reconstruct(s.input(), options);
  test::expect_promise(s, mesh, options.gap);
  int over = 0, under = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) (above(position(mesh, v)) > 0 ? over : under)++;
  EXPECT_GT(over, 1000 * 0.5 / GetParam());
  EXPECT_NEAR(over, under, 0.1 * over);
}

TEST_P(Film, of_a_lone_drop_is_flat_and_has_its_volume) {
  test::Random random(16);
  for (int n = 0; n < 20; ++n) {
    WaterScene s = film(100, 17);  // the sheet
    const double x = random.uniform(0.05, 0.07), y = random.uniform(0.05, 0.07);
    s.particles = {Vec3(x, y, height(x, y)) + random.uniform(0.15, 0.5) * s.spacing * normal};
    const ReconstructionOptions options = options_for(s, GetParam(), ObstacleMode::touch);
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    test::expect_promise(s, mesh, options.gap);
    EXPECT_NEAR(check_mesh(mesh, {}, 0).volume / std::pow(s.spacing, 3), 1, 0.1);
  }
}

TEST_P(Film, has_its_thickness_at_the_vertices) {
  const WaterScene s = film(2.0, 18);
  const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, GetParam(), ObstacleMode::touch));
  ASSERT_EQ(mesh.thickness.size(), mesh.positions.size());
  double squares = 0;
  int count = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 x = position(mesh, v);
    if (x.x() < 0.04 || x.x() > 0.08 || x.y() < 0.04 || x.y() > 0.08) continue;
    squares += std::pow(double(mesh.thickness[v]) / water_per_area(s, x - above(x) * normal) - 1, 2);
    ++count;
  }
  ASSERT_GT(count, 200);
  EXPECT_LT(std::sqrt(squares / count), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Cells, Film, testing::Values(0.25, 0.5, 0.8));

/// In the plane x + y + z = 0, whose normal has the direction of the padding of vectors.
TEST(FilmOnADiagonal, of_any_number_of_particles_is_made) {
  for (const double side : {1.0, -1.0})
    for (int count = 2; count < 20; ++count) {
      SCOPED_TRACE(count);
      WaterScene s;
      const Vec3 n = side * Vec3(1, 1, 1).normalized(), u = Vec3(1, -1, 0).normalized(), v = n.cross(u);
      s.vertices = {Vec3(1, -1, 0), Vec3(-1, 0, 1), Vec3(0, 1, -1)};
      s.triangles = {{0, 1, 2}};
      for (int i = 0; i < count; ++i)
        s.particles.push_back(s.spacing * (0.5 * n + double(i % 6) * u + double(i / 6) * v));
      const ReconstructionOptions options = options_for(s, 0.5, ObstacleMode::touch);
      const WaterMesh mesh = test::reconstruct(s.input(), options);
      test::expect_promise(s, mesh, options.gap);
      EXPECT_NEAR(check_mesh(mesh, {}, 0).volume / (count * std::pow(s.spacing, 3)), 1, 0.1);
    }
}

/// Films on planes that are tilted about an axis of the grid: rows of nodes in a layer of 1.25 cells were
/// joined by their corners only, and the film was cut across the slope into up to nine sheets.
TEST(FilmOnASlope, is_one_sheet) {
  for (const double degrees : {26.6, 30.0, 40.0, 50.0, 60.0})
    for (const double cell : {0.8, 1.0})
      for (const double per_area : {0.3, 0.6}) {
        SCOPED_TRACE(std::to_string(degrees) + ", cell " + std::to_string(cell));
        WaterScene s;
        const double dx = s.spacing, angle = degrees / 180 * 3.14159265358979,
                     between = 1 / std::sqrt(per_area);
        const Vec3 u(std::cos(angle), 0, std::sin(angle)), v(0, 1, 0), n = u.cross(v);
        s.add_sheet(4, [&](double a, double b) { return Vec3(60 * dx * ((a - 0.5) * u + (b - 0.5) * v)); });
        test::Random random(2);
        for (int i = -8; i < 8; ++i)
          for (int j = -8; j < 8; ++j)
            s.particles.push_back(dx * (between * (i * u + j * v) + 0.4 * n + random.in_cube(0.1)));
        const ReconstructionOptions options = options_for(s, cell, ObstacleMode::touch);
        const WaterMesh mesh = test::reconstruct(s.input(), options);
        test::expect_promise(s, mesh, options.gap);
        const MeshCheck check = check_mesh(mesh, {}, 0);
        EXPECT_EQ(check.components, 1u);
        EXPECT_NEAR(check.volume / (double(s.particles.size()) * std::pow(dx, 3)), 1, 0.01);
      }
}

/// A film between the layers of a folded sheet, and one on top of them.
TEST(FilmFold, keeps_the_layers_free) {
  for (const double distance : {0.4, 1.0, 2.0}) {
    WaterScene s;
    for (const double z : {0.0, distance * s.spacing})
      s.add_sheet(8, [&](double u, double v) {
        return Vec3(0.06 * u, 0.06 * v, z + test::waves(0.06 * u, 0.06 * v, 0.003, 0.03));
      });
    test::Random random(19);
    for (int n = 0; n < 300; ++n)
      s.particles.push_back(Vec3(random.uniform(0.01, 0.05), random.uniform(0.01, 0.05), 0) +
                            Vec3(0, 0, random.uniform(0, 1.5 * distance) * s.spacing));
    s.push_off(0.12);
    for (const double cell : {0.5, 0.8})
      for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
        const ReconstructionOptions options = options_for(s, cell, mode);
        test::expect_promise(s, test::reconstruct(s.input(), options), options.gap);
      }
  }
}

/// Particles between a spacing and the reach of films are no part of a film, so nothing thins the water
/// there.
TEST(FilmAbove, a_layer_off_the_cloth_keeps_its_volume) {
  for (const int sheets : {1, 2})
    for (const double height : {1.25, 1.5, 1.75})
      for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch})
        for (const double cell : {0.5, 0.8}) {
          // One sheet that is touched: it extends to it.
          if (mode == ObstacleMode::touch && height < 1.5 && sheets == 1) continue;
          WaterScene s;
          test::Random random(2);
          const double size = 24 * s.spacing;
          for (int n = 0; n < sheets; ++n)
            s.add_sheet(12, [&](double u, double v) {
              return Vec3((1.5 * u - 0.25) * size, (1.5 * v - 0.25) * size, 2 * n * height * s.spacing);
            });
          for (int n = 0; n < 24 * 24; ++n)
            s.particles.push_back(s.spacing *
                                  (Vec3(n % 24 + 0.5, n / 24 + 0.5, height) + random.in_cube(0.15)));
          ReconstructionReport report;
          test::reconstruct(s.input(), options_for(s, cell, 0, mode), &report);
          const double share = report.volume / (576 * std::pow(s.spacing, 3));
          EXPECT_NEAR(share, 1, 0.03) << sheets << ' ' << height << ' ' << int(mode) << ' ' << cell;
        }
}

}  // namespace
}  // namespace oilskin
