// Where the fit of the volume moves vertices far: the promise, the clip box, and data of the vertices.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/promise.h"

namespace oilskin {
namespace {

using test::WaterScene;

WaterScene unit_scene() {
  WaterScene s;
  s.spacing = 1;
  return s;
}

/// A triangle of this half width at the height h above the origin.
void add_triangle(WaterScene& s, double half, double h) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const Vec3& v : {Vec3(-half, -half, h), Vec3(half, -half, h), Vec3(0, half, h + 0.01)})
    s.vertices.push_back(v);
  s.triangles.push_back({first, first + 1, first + 2});
}

class FitPromise : public testing::TestWithParam<double> {};

TEST_P(FitPromise, holds_where_a_piece_has_much_more_water_than_its_mesh) {
  for (const double half : {8.0, 0.05})
    for (double h = 1.3; h < 4; h += 0.3) {
      WaterScene s = unit_scene();
      s.particles = {Vec3::Zero(), Vec3(0.6, 0, 0)};
      add_triangle(s, half, h);
      const std::vector<double> volumes = {50, 50};
      ReconstructionInput input = s.input();
      input.volumes = volumes;
      for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
        const ReconstructionOptions options = test::options_for(s, GetParam(), 0, mode);
        test::expect_promise(s, test::reconstruct(input, options), options.gap);
      }
    }
}

TEST_P(FitPromise, holds_for_compressed_water) {
  WaterScene s = unit_scene();
  for (int n = 0; n < 27; ++n) s.particles.push_back(0.1 * Vec3(n % 3, n / 3 % 3, n / 9));
  add_triangle(s, 8, 1.8);
  const ReconstructionOptions options = test::options_for(s, GetParam(), 0, ObstacleMode::gap);
  test::expect_promise(s, test::reconstruct(s.input(), options), options.gap);
}

/// So much that a piece grows beyond where obstacles are looked for.
TEST(FitPromiseFar, holds_for_much_compressed_water) {
  test::Random random(3);
  WaterScene s = unit_scene();
  while (s.particles.size() < 6000)
    if (const Vec3 x = random.in_cube(3.4); x.norm() < 3.4) s.particles.push_back(x);
  for (const double h : {8.0, 10.2, 10.8}) {
    s.vertices.clear();
    s.triangles.clear();
    add_triangle(s, 8, h);
    const ReconstructionOptions options = test::options_for(s, 0.1, 0, ObstacleMode::gap);
    test::expect_promise(s, test::reconstruct(s.input(), options), options.gap);
  }
}

/// Crumbs of obstacles that lie outside the water before it grows.
TEST_P(FitPromise, holds_among_crumbs) {
  std::size_t held = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    WaterScene s = unit_scene();
    test::Random random(seed);
    for (int n = 0; n < 5; ++n) s.particles.push_back(random.in_cube(1));
    for (int n = 0; n < 60; ++n) {
      const Vec3 x = random.in_cube(1.8);
      const auto first = static_cast<std::uint32_t>(s.vertices.size());
      for (int k = 0; k < 3; ++k) s.vertices.push_back(x + random.in_cube(0.004));
      s.triangles.push_back({first, first + 1, first + 2});
    }
    const std::vector<double> volumes(s.particles.size(), 3);
    ReconstructionInput input = s.input();
    input.volumes = volumes;
    for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
      const ReconstructionOptions options = test::options_for(s, GetParam(), 0, mode);
      ReconstructionReport report;
      test::expect_promise(s, test::reconstruct(input, options, &report), options.gap);
      held += report.vertices_held;
    }
  }
  EXPECT_GT(held, 0u) << "the case tests nothing";
}

/// Vertices at cut edges, of films, and of drops that an obstacle flattens.
TEST_P(FitPromise, no_vertex_leaves_the_clip_box) {
  std::size_t at_side = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    WaterScene s = unit_scene();
    test::Random random(seed);
    const int count = 1 + int(random.below(3));
    for (int n = 0; n < count; ++n) s.particles.push_back(random.in_cube(0.6));
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1);
    s.add_sheet(2, [&](double u, double v) {
      const double x = 12 * u - 6, y = 12 * v - 6;
      return Vec3(x, y, a * x + b * y - 0.3);
    });
    ReconstructionOptions options =
        test::options_for(s, GetParam(), 0, seed % 2 ? ObstacleMode::gap : ObstacleMode::touch);
    options.keep_volume = seed % 3 != 0;
    const double half = random.uniform(0.3, 1.2);
    options.clip = Box{Vec3::Constant(-half), Vec3::Constant(half)};
    const std::vector<double> volumes(s.particles.size(), seed % 5 == 0 ? 5 : 1);
    ReconstructionInput input = s.input();
    input.volumes = volumes;
    const WaterMesh mesh = test::reconstruct(input, options);
    const double margin = 0.0101 * GetParam();
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 x = test::position(mesh, v);
      ASSERT_LE(x.cwiseAbs().maxCoeff(), half + margin) << seed;
      at_side += x.cwiseAbs().maxCoeff() > half - margin;
    }
    test::expect_promise(s, mesh, options.gap);
  }
  EXPECT_GT(at_side, 100u) << "the case tests nothing";
}

/// With a gap the film is not where its particles are; they must not become drops as well.
TEST_P(FitPromise, a_film_within_the_gap_is_drawn_once) {
  WaterScene s = unit_scene();
  for (int n = 0; n < 64; ++n) s.particles.emplace_back(n % 8, n / 8, 0.2);
  s.add_sheet(2, [](double u, double v) { return Vec3(20 * u - 6, 20 * v - 6, 0); });
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
    ReconstructionReport report;
    test::reconstruct(s.input(), test::options_for(s, GetParam(), 1, mode), &report);
    EXPECT_EQ(report.drops, 0u);
    EXPECT_NEAR(report.volume, 64, 0.15 * 64);
  }
}

TEST_P(FitPromise, each_side_of_a_sheet_has_its_own_water) {
  WaterScene s = unit_scene();
  s.particles = {Vec3(0.2237, -0.6526, -0.2195), Vec3(0.2377, 0.0951, 0.5838)};
  s.add_sheet(2, [](double u, double v) { return Vec3(20 * u - 10, 20 * v - 10, -0.1952); });
  ReconstructionReport report;
  test::reconstruct(s.input(), test::options_for(s, GetParam(), 0, ObstacleMode::touch), &report);
  EXPECT_NEAR(report.volume, 2, 0.2);
}

TEST_P(FitPromise, the_nearest_particle_is_that_also_of_vertices_that_moved_far) {
  WaterScene s = unit_scene();
  test::Random random(4);
  for (int n = 0; n < 8; ++n) s.particles.push_back(random.in_cube(0.8));
  for (const double volume : {10.0, 1000.0}) {
    const std::vector<double> volumes(s.particles.size(), volume);
    ReconstructionInput input = s.input();
    input.volumes = volumes;
    ReconstructionOptions options = test::options_for(s, GetParam(), 0, ObstacleMode::none);
    options.nearest = true;
    ReconstructionReport report;
    const WaterMesh mesh = test::reconstruct(input, options, &report);
    ASSERT_EQ(report.drops, 0u);
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 x = test::position(mesh, v);
      double least = INFINITY;
      for (const Vec3& p : s.particles) least = std::min(least, (p - x).norm());
      ASSERT_LT(mesh.nearest[v], s.particles.size());
      ASSERT_LT((s.particles[mesh.nearest[v]] - x).norm(), least + 1e-4) << volume;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, FitPromise, testing::Values(0.1, 0.5, 1.0));

TEST(OverlapMode, draws_no_water_beyond_the_reach_of_particles) {
  WaterScene s = unit_scene();
  for (int n = 0; n < 27; ++n) s.particles.emplace_back(n % 3, n / 3 % 3, n / 9);
  s.add_sheet(2, [](double u, double v) { return Vec3(20 * u - 9, 20 * v - 9, -1); });
  ReconstructionOptions options = test::options_for(s, 0.5, 0, ObstacleMode::overlap);
  options.kernel_radius = options.touch_range = 1.5;
  for (const double depth : {0.3, 0.6, 1.0}) {
    options.overlap_depth = depth;
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
      ASSERT_LT((test::position(mesh, v) - Vec3::Ones()).cwiseAbs().maxCoeff(), 3) << depth;
  }
}

/// Beside the border of a sheet another one lies below, in sight of the film on the first.
TEST(TouchMode, draws_no_film_on_another_sheet_below) {
  WaterScene s = unit_scene();
  for (int n = 0; n < 24; ++n) s.particles.emplace_back(-0.1 - n % 3, n / 3, 0.3);
  s.add_sheet(4, [](double u, double v) { return Vec3(6 * u - 6, 12 * v - 2, 0); });
  s.add_sheet(4, [](double u, double v) { return Vec3(12 * u - 6, 12 * v - 2, -3.2); });
  for (const double cell : {0.5, 1.0}) {
    ReconstructionOptions options = test::options_for(s, cell, 0.1, ObstacleMode::touch);
    options.kernel_radius = 4;
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
      ASSERT_GT(test::position(mesh, v).z(), -2.5) << cell;
  }
}

TEST(MinBlob, is_compared_with_the_water_that_the_mesh_will_enclose) {
  WaterScene s = unit_scene();
  for (int n = 0; n < 7; ++n) s.particles.emplace_back(0.9 * n, 0.2 * (n % 2), 0);
  for (const double cell : {0.4, 0.8}) {
    ReconstructionOptions options = test::options_for(s, cell, 0, ObstacleMode::none);
    ReconstructionReport report;
    options.min_blob = 6.5;
    test::reconstruct(s.input(), options, &report);
    EXPECT_NEAR(report.volume, 7, 0.1);
    options.min_blob = 7.5;
    test::reconstruct(s.input(), options, &report);
    EXPECT_EQ(report.volume, 0);
    EXPECT_EQ(report.blobs_removed, 1u);
  }
}

}  // namespace
}  // namespace oilskin
