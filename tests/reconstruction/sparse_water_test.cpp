// Water with air between its particles, as in spray: the mesh has the volume of the water there (R.41), and
// no bubble that has closed.
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/mesh_parts.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::WaterScene;

/// Of all scenes [spacings]: the audit needs coordinates away from 0.
const Vec3 middle(40, 40, 40);

/// Particles at random places in a box of `size` spacings, with a `density` relative to that of water.
WaterScene cloud(double density, const Vec3& size, std::uint64_t seed) {
  WaterScene s;
  test::Random random(seed);
  const auto count = static_cast<int>(density * size.prod());
  for (int n = 0; n < count; ++n)
    s.particles.push_back(s.spacing * (middle + random.in_cube(0.5).cwiseProduct(size)));
  return s;
}

class SparseWater : public testing::TestWithParam<double> {
 protected:
  static ReconstructionOptions options_for(const WaterScene& s, int smoothing,
                                           ObstacleMode mode = ObstacleMode::none) {
    ReconstructionOptions options = test::options_for(s, GetParam(), 0.1, mode);
    options.smoothing_iterations = smoothing;
    return options;
  }
};

/// The field of normalised volumes fills the space between the particles: it was 1.07 to 1.3 times the water.
TEST_P(SparseWater, has_its_volume_wherever_the_grid_lies) {
  for (const double density : {0.3, 0.45, 0.6, 0.75})
    for (const int smoothing : {0, 10}) {
      WaterScene s = cloud(density, {16, 16, 16}, 11);
      for (int shift = 0; shift < 2; ++shift) {
        for (Vec3& p : s.particles) p += shift * 0.37 * GetParam() * s.spacing * Vec3(1, 0.6, 0.3);
        ReconstructionReport report;
        const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, smoothing), &report);
        test::expect_closed(check_mesh(mesh, {}, 0));
        EXPECT_NEAR(test::share_of(report, s), 1, 0.01) << density << ' ' << smoothing << ' ' << shift;
      }
    }
}

TEST_P(SparseWater, has_its_volume_on_both_sides_of_a_sheet) {
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
    WaterScene s = cloud(0.5, {16, 16, 30}, 12);
    s.add_sheet(
        12, [&](double u, double v) { return Vec3(s.spacing * (middle + 20 * Vec3(u - 0.5, v - 0.5, 0))); });
    s.push_off(0.2);
    test::expect_promise_and_volume(s, options_for(s, 10, mode), 0.02);
  }
}

TEST_P(SparseWater, gives_the_same_mesh_on_any_number_of_threads) {
  const WaterScene s = cloud(0.5, {20, 20, 20}, 13);
  test::expect_same_on_any_number_of_threads(s, options_for(s, 5));
}

/// Particles side by side are no spray, however little water they have.
TEST_P(SparseWater, of_particles_side_by_side_stays_whole) {
  WaterScene s;
  s.add_water({Vec3::Zero(), 12 * s.spacing * Vec3::Ones()}, 0.2, 5);
  const std::vector<double> volumes(s.particles.size(), 0.5 * std::pow(s.spacing, 3));
  ReconstructionInput thin = s.input();
  thin.volumes = volumes;
  const WaterMesh expected = test::reconstruct(s.input(), options_for(s, 0));
  EXPECT_EQ(test::reconstruct(thin, options_for(s, 0)).triangles, expected.triangles);
}

/// Where water lacks volume its surface moves into bubbles. One that was turned inside out counted as a piece
/// of the water around it, and was blown up to that: 0.78 to 2 times the volume.
TEST_P(SparseWater, closes_bubbles) {
  for (const int smoothing : {0, 10}) {
    const WaterScene s = cloud(1.1, {16, 16, 16}, 14);
    ReconstructionReport report;
    const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, smoothing), &report);
    EXPECT_NEAR(test::share_of(report, s), 1, 0.02) << smoothing;
    std::size_t pieces = 0;
    for (const test::MeshPart& part : test::parts_of(mesh)) pieces += part.volume > 0;
    test::record("pieces, smoothing " + std::to_string(smoothing), double(pieces));
    EXPECT_EQ(pieces, 1u) << "others are bubbles turned inside out";
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    EXPECT_EQ(mesh.thickness.size(), mesh.positions.size());
  }
}

/// Crumbs and bubbles of a single node of the grid, with 8 triangles, were turned inside out where the
/// surface moved past them: hundreds of specks in the air and in the water.
TEST_P(SparseWater, has_no_specks) {
  for (const double density : {0.35, 0.7})
    for (const int smoothing : {0, 10}) {
      const WaterScene s = cloud(density, {16, 16, 16}, 15);
      const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, smoothing));
      for (const test::MeshPart& part : test::parts_of(mesh))
        EXPECT_TRUE(part.volume > 0 || part.triangles > 8) << density << ' ' << smoothing;
    }
}

/// A layer around a ball, and a hollow drop: their surfaces outside were fitted to the water as if the rest
/// were full.
TEST_P(SparseWater, around_a_cavity_has_its_volume) {
  for (const bool with_ball : {true, false}) {
    WaterScene s;
    constexpr double radius = 3;
    test::Random random(16);
    while (s.particles.size() < 150) {
      const Vec3 p = middle + random.uniform(radius + 0.4, radius + 0.7) * random.direction();
      const bool is_free = std::all_of(s.particles.begin(), s.particles.end(),
                                       [&](const Vec3& q) { return (p - q / s.spacing).norm() > 0.75; });
      if (is_free) s.particles.push_back(s.spacing * p);
    }
    if (with_ball)
      s.add_sheet(16, [&](double u, double v) {
        const double around = 6.2831853 * u, up = 3.1415926 * v;
        return Vec3(s.spacing * (middle + radius * Vec3(std::sin(up) * std::cos(around),
                                                        std::sin(up) * std::sin(around), std::cos(up))));
      });
    const ReconstructionOptions options =
        options_for(s, 0, with_ball ? ObstacleMode::touch : ObstacleMode::none);
    ReconstructionReport report;
    const WaterMesh mesh = test::reconstruct(s.input(), options, &report);
    if (with_ball) test::expect_clean(check_mesh(mesh, s.obstacles(), options.gap), options.gap);
    EXPECT_NEAR(test::share_of(report, s), 1, 0.02) << with_ball;
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, SparseWater, testing::Values(0.5, 0.8, 1.0));

}  // namespace
}  // namespace oilskin
