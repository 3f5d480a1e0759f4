// The mesh encloses the volume of the water, whatever the water looks like.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/promise.h"

namespace oilskin {
namespace {

using test::WaterScene;

ReconstructionOptions options_for(const WaterScene& s, double cell,
                                  ObstacleMode contact = ObstacleMode::none) {
  return test::options_for(s, cell, 0.1, contact);
}

/// The volume of the mesh over that of the water.
double share(const WaterScene& s, const ReconstructionOptions& options) {
  const WaterMesh mesh = test::reconstruct(s.input(), options);
  const MeshCheck check = check_mesh(mesh, {}, 0);
  test::expect_closed(check);
  return check.volume / (double(s.particles.size()) * std::pow(s.spacing, 3));
}

double area(const WaterMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    Vec3 c[3];
    for (std::size_t k = 0; k < 3; ++k) c[k] = test::position(mesh, t[k]);
    sum += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
  }
  return sum;
}

/// A clump in which each particle is 0.8 to 1.2 spacings from an earlier one, and not nearer to others.
WaterScene clump(int count, std::uint64_t seed) {
  test::Random random(seed);
  WaterScene s;
  s.particles.push_back(random.in_cube(0.5));
  while (int(s.particles.size()) < count) {
    const Vec3& from = s.particles[random.below(std::uint32_t(s.particles.size()))];
    const Vec3 p = from + random.uniform(0.8, 1.2) * s.spacing * random.direction();
    const bool is_free = std::all_of(s.particles.begin(), s.particles.end(),
                                     [&](const Vec3& q) { return (p - q).norm() > 0.79 * s.spacing; });
    if (is_free) s.particles.push_back(p);
  }
  return s;
}

class Volume : public testing::TestWithParam<double> {};

TEST_P(Volume, of_a_lone_drop_is_kept_at_any_place_on_the_grid) {
  test::Random random(1);
  for (int n = 0; n < 50; ++n) {
    WaterScene s;
    s.particles = {random.in_cube(1)};
    EXPECT_NEAR(share(s, options_for(s, GetParam())), 1, 1e-3);
  }
}

TEST_P(Volume, of_a_drop_is_that_of_its_particle) {
  WaterScene s;
  s.particles = {Vec3::Zero(), Vec3(0.1, 0, 0), Vec3(0.2, 0, 0)};
  const std::vector<double> volumes = {1e-7, 3e-8, 0};
  ReconstructionInput input = s.input();
  input.volumes = volumes;
  ReconstructionReport report;
  test::reconstruct(input, options_for(s, GetParam()), &report);
  EXPECT_NEAR(report.volume, 1.3e-7, 1e-10);
  EXPECT_EQ(report.drops, 2u) << "a particle without water is no drop";
}

TEST_P(Volume, of_small_pieces_is_kept) {
  double worst = 0;
  for (int n = 2; n <= 19; ++n)
    for (std::uint64_t seed : {7u, 8u, 9u}) {
      const WaterScene s = clump(n, 100 * seed + std::uint64_t(n));
      worst = std::max(worst, std::abs(share(s, options_for(s, GetParam())) - 1));
    }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 0.1);
}

TEST_P(Volume, of_larger_pieces_is_kept) {
  WaterScene sheet, strand;
  test::Random random(3);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      sheet.particles.push_back(1.3 * sheet.spacing * Vec3(i, j, 0.5 * i) +
                                sheet.spacing * random.in_cube(0.1));
  for (int i = 0; i < 30; ++i)
    strand.particles.push_back(1.1 * strand.spacing * Vec3(i, 0.3 * i, 0.2 * i) +
                               strand.spacing * random.in_cube(0.1));
  const WaterScene pieces[] = {sheet, strand, clump(60, 5), clump(300, 6)};
  for (const WaterScene& s : pieces)
    EXPECT_NEAR(share(s, options_for(s, GetParam())), 1, 0.05) << s.particles.size();
}

/// A block on a wavy sheet, drops and clumps above it.
WaterScene splash() {
  WaterScene s = test::wavy_scene(false);
  test::Random random(4);
  for (int n = 0; n < 400; ++n)
    s.particles.push_back(Vec3(random.uniform(0, 0.1), random.uniform(0, 0.1), random.uniform(0.06, 0.12)));
  s.push_off(0.2);
  return s;
}

TEST_P(Volume, of_a_splash_on_a_sheet_is_kept_in_each_mode_with_the_promise) {
  const WaterScene s = splash();
  for (const ObstacleMode mode : {ObstacleMode::none, ObstacleMode::gap, ObstacleMode::touch})
    for (const int smoothing : {0, 10}) {
      ReconstructionOptions options = options_for(s, GetParam(), mode);
      options.smoothing_iterations = smoothing;
      EXPECT_NEAR(share(s, options), 1, 0.03) << int(mode) << ' ' << smoothing;
      if (mode == ObstacleMode::none) continue;
      test::expect_promise(s, test::reconstruct(s.input(), options), options.gap);
    }
}

TEST_P(Volume, is_not_fitted_if_it_shall_not_be) {
  WaterScene s;
  s.particles = {Vec3::Zero()};
  ReconstructionOptions options = options_for(s, GetParam());
  options.keep_volume = false;
  EXPECT_LT(share(s, options), 0.6);
  for (const ObstacleMode mode : {ObstacleMode::reset, ObstacleMode::overlap}) {
    ReconstructionReport report;
    EXPECT_TRUE(test::reconstruct(s.input(), options_for(s, GetParam(), mode), &report).thickness.empty());
    EXPECT_EQ(report.drops, 0u);
  }
}

TEST_P(Volume, and_area_do_not_depend_on_the_place_of_the_grid) {
  const WaterScene s = splash();
  const ReconstructionOptions options = options_for(s, GetParam(), ObstacleMode::touch);
  const WaterMesh mesh = test::reconstruct(s.input(), options);
  WaterScene moved = s;
  const Vec3 by = Vec3::Constant(0.37 * GetParam() * s.spacing);
  for (Vec3& p : moved.particles) p += by;
  for (Vec3& v : moved.vertices) v += by;
  const WaterMesh other = test::reconstruct(moved.input(), options);
  const double volume = check_mesh(mesh, {}, 0).volume;
  EXPECT_NEAR(check_mesh(other, {}, 0).volume, volume, 0.02 * volume);
  EXPECT_NEAR(area(other), area(mesh), 0.02 * area(mesh));
}

TEST_P(Volume, of_small_pieces_is_kept_where_smoothing_shrinks_them) {
  for (const int count : {2, 3, 5, 10})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const WaterScene s = clump(count, 100 * seed + std::uint64_t(count));
      ReconstructionOptions options = options_for(s, GetParam());
      options.smoothing_iterations = 40;
      EXPECT_NEAR(share(s, options), 1, 0.01) << count << ' ' << seed;
    }
}

TEST_P(Volume, of_a_block_is_hardly_changed_by_much_smoothing) {
  WaterScene s;
  s.add_water({Vec3::Zero(), Vec3::Constant(6 * s.spacing)}, 0.1, 3);
  ReconstructionOptions options = options_for(s, GetParam());
  const auto smoothed = [&](int iterations) {
    options.smoothing_iterations = iterations;
    return share(s, options);
  };
  EXPECT_NEAR(smoothed(1000), 1, 0.01);
  options.keep_volume = false;
  const double without = smoothed(0);
  EXPECT_NEAR(smoothed(40), without, 0.02 * without);
}

TEST_P(Volume, takes_no_vertex_out_of_the_clip_box) {
  WaterScene s;
  test::Random random(12);
  for (std::uint64_t n = 0; n < 60; ++n) {
    const Vec3 at(random.uniform(0, 0.1), random.uniform(0, 0.1), random.uniform(0, 0.05));
    for (const Vec3& p : clump(2 + int(n % 9), n).particles) s.particles.push_back(at + p);
  }
  s.add_sheet(6, [](double u, double v) { return Vec3(0.1 * u, 0.1 * v, 0.02); });
  s.push_off(0.2);
  for (const ObstacleMode mode : {ObstacleMode::none, ObstacleMode::gap, ObstacleMode::touch})
    for (const int smoothing : {0, 40}) {
      ReconstructionOptions options = options_for(s, GetParam(), mode);
      options.smoothing_iterations = smoothing;
      options.clip = Box{Vec3(0.011, 0.02, 0.001), Vec3(0.08, 0.091, 0.043)};
      const WaterMesh mesh = test::reconstruct(s.input(), options);
      const Box allowed = options.clip->inflated(0.01 * GetParam() * s.spacing);
      for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
        ASSERT_TRUE(allowed.contains(test::position(mesh, v))) << int(mode) << ' ' << smoothing;
      if (mode != ObstacleMode::none) test::expect_promise(s, mesh, options.gap);
    }
}

TEST_P(Volume, of_0_is_no_water) {
  WaterScene s = splash();
  const ReconstructionOptions options = options_for(s, GetParam(), ObstacleMode::touch);
  const WaterMesh plain = test::reconstruct(s.input(), options);
  std::vector<double> volumes(s.particles.size(), std::pow(s.spacing, 3));
  s.particles.push_back(s.particles[0]);
  s.particles.push_back(Vec3(0.3, 0, 0));
  s.particles.push_back(Vec3(0.302, 0, 0));
  volumes.resize(s.particles.size(), 0);
  ReconstructionInput input = s.input();
  input.volumes = volumes;
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(input, options, &report);
  EXPECT_EQ(mesh.triangles, plain.triangles);
  EXPECT_EQ(mesh.positions, plain.positions);
  EXPECT_EQ(report.particles_skipped, 0u);
}

INSTANTIATE_TEST_SUITE_P(Cells, Volume, testing::Values(0.5, 0.8));

/// A sheet so small that the drop's surface is far from it.
TEST(VolumeDrop, swallows_no_obstacle) {
  for (const double volume : {20.0, 60.0, 300.0, 1000.0}) {
    WaterScene s;
    s.particles = {Vec3::Zero()};
    s.add_sheet(2, [&](double u, double v) -> Vec3 { return s.spacing * Vec3(0.3 * u + 0.7, 0.3 * v, 0.2); });
    s.add_sheet(1, [&](double u, double v) -> Vec3 { return s.spacing * Vec3(0.1 * u + 7, 0.1 * v, 0.2); });
    const std::vector<double> volumes = {volume * std::pow(s.spacing, 3)};
    ReconstructionInput input = s.input();
    input.volumes = volumes;
    for (const double cell : {0.1, 0.5, 1.0}) {
      const ReconstructionOptions options = options_for(s, cell, ObstacleMode::gap);
      ReconstructionReport report;
      test::expect_promise(s, test::reconstruct(input, options, &report), options.gap);
      EXPECT_EQ(report.drops, 1u) << volume;
    }
  }
}

TEST(VolumeInput, that_cannot_be_is_refused) {
  WaterScene s;
  s.particles = {Vec3::Zero(), Vec3(1, 0, 0)};
  ReconstructionInput input = s.input();
  WaterMesh mesh;
  for (const std::vector<double>& volumes :
       {std::vector<double>{1e-7}, {1e-7, -1e-9}, {1e-7, std::nan("")}, {1e-7, INFINITY}, {1e-7, 1.3e-4}}) {
    input.volumes = volumes;
    const Status status = reconstruct_surface(input, options_for(s, 0.5), &mesh);
    EXPECT_FALSE(status.ok());
    EXPECT_NE(status.message.find("volume"), std::string::npos) << status.message;
  }
}

TEST(VolumeClip, leaves_drops_out_that_are_not_wholly_inside) {
  WaterScene s;
  s.particles = {Vec3(0, 0, 0), Vec3(0.05, 0, 0)};
  ReconstructionOptions options = options_for(s, 0.5);
  options.clip = Box{Vec3::Constant(-0.01), Vec3(0.051, 0.01, 0.01)};
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(s.input(), options, &report);
  EXPECT_EQ(report.drops, 1u);
  EXPECT_EQ(report.drops_left_out, 1u);
  EXPECT_NEAR(report.volume, std::pow(s.spacing, 3), 1e-10);
}

/// Water that must expand, with crumbs of an obstacle around it that no grid edge crosses.
TEST(VolumeFit, swallows_no_piece_of_an_obstacle) {
  WaterScene s;
  s.add_water({Vec3::Zero(), Vec3::Constant(0.04)}, 0.1, 6);
  test::Random random(7);
  for (int n = 0; n < 300; ++n) {
    const Vec3 x(random.uniform(0, 0.04), random.uniform(0, 0.04), 0.04 + random.uniform(0, 0.003));
    const auto first = std::uint32_t(s.vertices.size());
    for (int k = 0; k < 3; ++k) s.vertices.push_back(x + random.in_cube(1e-4));
    s.triangles.push_back({first, first + 1, first + 2});
  }
  const std::vector<double> volumes(s.particles.size(), 1.4 * std::pow(s.spacing, 3));
  ReconstructionInput input = s.input();
  input.volumes = volumes;
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
    ReconstructionOptions options = options_for(s, 0.5, mode);
    options.gap = 0;
    test::expect_clean(check_mesh(test::reconstruct(input, options), input.obstacles, 0), 0);
  }
}

}  // namespace
}  // namespace oilskin
