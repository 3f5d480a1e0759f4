// Sparse water in which the particles lie evenly, as in a jet that falls: the mesh gets narrower, as water
// does (R.42). The field of the particles encloses up to 2 times the water, and would be full of holes at a
// level that encloses no more.
#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "reconstruction/mesh_parts.h"
#include "reconstruction/node_blur.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::WaterScene;

/// Of all scenes [spacings]: the audit needs coordinates away from 0.
const Vec3 middle(40, 40, 40);

/// Particles on a lattice that is stretched along z, within `radius` of an axis, each moved at random by up
/// to `disorder` along each axis. [spacings]
WaterScene stream(double radius, double length, double stretch, double disorder, std::uint64_t seed) {
  WaterScene s;
  test::Random random(seed);
  const int around = static_cast<int>(radius), layers = static_cast<int>(length / stretch);
  for (int k = 0; k < layers; ++k)
    for (int j = -around; j <= around; ++j)
      for (int i = -around; i <= around; ++i)
        if (std::hypot(i, j) <= radius)
          s.particles.push_back(s.spacing * (middle + Vec3(i, j, stretch * (k - 0.5 * (layers - 1))) +
                                             random.in_cube(disorder)));
  return s;
}

/// Of a stream: the mean distance of vertices from the axis, away from its ends [spacings].
double mean_radius(const WaterScene& s, const WaterMesh& mesh, double length) {
  double sum = 0, count = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 x = test::position(mesh, v) / s.spacing - middle;
    if (std::abs(x.z()) > 0.25 * length) continue;
    sum += std::hypot(x.x(), x.y());
    ++count;
  }
  return sum / count;
}

class EvenWater : public testing::TestWithParam<double> {
 protected:
  static ReconstructionOptions options_for(const WaterScene& s, int smoothing = 0,
                                           ObstacleMode mode = ObstacleMode::none) {
    ReconstructionOptions options = test::options_for(s, GetParam(), 0.1, mode);
    options.smoothing_iterations = smoothing;
    return options;
  }
};

TEST_P(EvenWater, that_is_stretched_is_narrower_and_whole) {
  for (const double radius : {3.2, 5.2, 8.2})
    for (const double stretch : {1.15, 1.4, 1.75}) {
      const double length = 8 * radius;
      const WaterScene s = stream(radius, length, stretch, 0.15, 21);
      ReconstructionReport report;
      const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, 10), &report);
      test::expect_closed(check_mesh(mesh, {}, 0));
      const std::string which = std::to_string(radius) + " stretched " + std::to_string(stretch);
      EXPECT_NEAR(test::share_of(report, s), 1, 0.005) << which;
      EXPECT_EQ(test::parts_of(mesh).size(), 1u) << which << ": bubbles, or crumbs";
      EXPECT_EQ(report.drops, 0u) << which;
      // Water has the cross-section of its layers of particles, one in each `stretch`.
      const double layers = std::floor(length / stretch), in_layer = double(s.particles.size()) / layers;
      const double expected = std::sqrt(in_layer / (3.14159265 * stretch));
      test::record("radius, " + which, mean_radius(s, mesh, length) / expected);
      EXPECT_NEAR(mean_radius(s, mesh, length) / expected, 1, 0.04) << which;
    }
}

/// Towards the place of its particles: cubes of nodes are half a cell lower than those of cells.
TEST_P(EvenWater, is_drawn_in_from_all_sides_alike) {
  for (const double radius : {5.2, 8.2}) {
    WaterScene s = stream(radius, 6 * radius, 1.5, 0.1, 30);
    for (Vec3& p : s.particles) p += 0.31 * s.spacing * Vec3(1, 2, -1);
    const WaterMesh mesh = test::reconstruct(s.input(), options_for(s));
    Vec3 of_particles = Vec3::Zero(), of_mesh = Vec3::Zero();
    for (const Vec3& p : s.particles) of_particles += p / double(s.particles.size());
    double volume = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = test::position(mesh, t[0]) - of_particles, b = test::position(mesh, t[1]) - of_particles,
                 c = test::position(mesh, t[2]) - of_particles;
      const double part = a.dot(b.cross(c)) / 6;
      volume += part;
      of_mesh += part * (a + b + c) / 4;
    }
    const Vec3 shift = of_mesh / (volume * s.spacing);
    test::record("shift, radius " + std::to_string(radius), shift.norm());
    EXPECT_LT(shift.norm(), 0.15) << radius << ": " << shift.transpose();
  }
}

/// Sheets of up to three layers, which the grid hardly resolves, keep their surface.
TEST_P(EvenWater, in_thin_sheets_stays) {
  for (const int layers : {1, 2, 3})
    for (const double stretch : {1.1, 1.25}) {
      WaterScene s;
      test::Random random(31);
      for (int k = 0; k < layers; ++k)
        for (int j = 0; j < 24; ++j)
          for (int i = 0; i < 24; ++i)
            s.particles.push_back(s.spacing *
                                  (middle + Vec3(stretch * i, stretch * j, k) + random.in_cube(0.1)));
      ReconstructionReport report;
      const WaterMesh mesh = test::reconstruct(s.input(), options_for(s), &report);
      EXPECT_EQ(report.drops, 0u) << layers << ' ' << stretch;
      EXPECT_EQ(test::parts_of(mesh).size(), 1u) << layers << ' ' << stretch;
      EXPECT_NEAR(test::share_of(report, s), 1, 0.03) << layers << ' ' << stretch;
    }
}

/// Wider water is drawn in in several rounds.
TEST_P(EvenWater, that_is_wide_is_whole) {
  WaterScene s;
  test::Random random(22);
  constexpr int wide = 24;
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < wide; ++j)
      for (int i = 0; i < wide; ++i)
        s.particles.push_back(s.spacing * (middle + Vec3(i, j, 1.6 * k) + random.in_cube(0.1)));
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(s.input(), options_for(s), &report);
  EXPECT_NEAR(test::share_of(report, s), 1, 0.005);
  EXPECT_EQ(test::parts_of(mesh).size(), 1u);
  EXPECT_EQ(report.drops, 0u);
}

/// Particles that lie 1.3 spacings from each other in all directions had up to 1.8 times their volume.
TEST_P(EvenWater, that_has_been_spread_has_its_volume) {
  WaterScene s;
  test::Random random(23);
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 10; ++i)
        s.particles.push_back(s.spacing * (middle + 1.3 * Vec3(i, j, k) + random.in_cube(0.1)));
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(s.input(), options_for(s), &report);
  EXPECT_NEAR(test::share_of(report, s), 1, 0.005);
  EXPECT_EQ(test::parts_of(mesh).size(), 1u);
}

/// What is left out must be connected to what stays.
TEST_P(EvenWater, leaves_the_water_beside_it) {
  for (const int edge : {2, 3, 5}) {
    WaterScene s = stream(5.2, 40, 1.6, 0.1, 24);
    test::Random random(25);
    const double volume = edge * edge * edge;
    for (int k = 0; k < edge; ++k)
      for (int j = 0; j < edge; ++j)
        for (int i = 0; i < edge; ++i)
          s.particles.push_back(s.spacing * (middle + Vec3(9 + i, j, k) + random.in_cube(0.1)));
    const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, 10));
    const std::vector<test::MeshPart> parts = test::parts_of(mesh);
    ASSERT_EQ(parts.size(), 2u) << edge;
    const double smaller = std::min(parts[0].volume, parts[1].volume) / std::pow(s.spacing, 3);
    EXPECT_NEAR(smaller / volume, 1, 0.01) << edge;
  }
}

TEST_P(EvenWater, leaves_a_thread_beside_it) {
  WaterScene s = stream(4.2, 40, 1.6, 0.1, 32);
  constexpr int length = 30;
  for (int k = 0; k < length; ++k)
    for (const int j : {0, 1}) s.particles.push_back(s.spacing * (middle + Vec3(7.5, j, k - 15)));
  const std::vector<test::MeshPart> parts = test::parts_of(test::reconstruct(s.input(), options_for(s, 10)));
  ASSERT_EQ(parts.size(), 2u);
  const double smaller = std::min(parts[0].volume, parts[1].volume) / std::pow(s.spacing, 3);
  EXPECT_NEAR(smaller / (2 * length), 1, 0.02);
}

TEST_P(EvenWater, that_falls_on_a_sheet_keeps_the_promise) {
  for (const ObstacleMode mode : {ObstacleMode::gap, ObstacleMode::touch}) {
    WaterScene s = stream(5.2, 30, 1.5, 0.1, 26);
    s.add_sheet(16, [&](double u, double v) {
      return Vec3(s.spacing * (middle + Vec3(24 * (u - 0.5), 24 * (v - 0.5), 3 * std::sin(5 * u) - 9)));
    });
    s.push_off(0.2);
    test::expect_promise_and_volume(s, options_for(s, 10, mode), 0.01);
  }
}

/// A little more stretch changes little: before, the field was one body up to a stretch of 1.5, then many.
TEST_P(EvenWater, changes_continuously) {
  double before = 0;
  for (int n = 0; n < 9; ++n) {
    const double stretch = 1 + 0.1 * n;
    WaterScene s = stream(5.2, 24, 1, 0.15, 27);
    for (Vec3& p : s.particles) p.z() = s.spacing * middle.z() + stretch * (p.z() - s.spacing * middle.z());
    ReconstructionReport report;
    const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, 10), &report);
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = test::position(mesh, t[0]);
      area += (test::position(mesh, t[1]) - a).cross(test::position(mesh, t[2]) - a).norm() / 2;
    }
    // The sides of a cylinder grow with the root of its length.
    area /= std::sqrt(stretch);
    if (before > 0) {
      EXPECT_NEAR(area / before, 1, 0.08) << stretch;
    }
    before = area;
    EXPECT_NEAR(test::share_of(report, s), 1, 0.005) << stretch;
  }
}

TEST_P(EvenWater, gives_the_same_mesh_on_any_number_of_threads) {
  const WaterScene s = stream(6.2, 30, 1.6, 0.1, 28);
  test::expect_same_on_any_number_of_threads(s, options_for(s, 5));
}

INSTANTIATE_TEST_SUITE_P(Cells, EvenWater, testing::Values(0.5, 0.8, 1.0));

/// The mean over half of the space is the integral of the Gaussian, also across blocks.
TEST(InsideShares, of_a_half_space_are_those_of_a_gaussian) {
  using namespace reconstruction;
  Grid grid;
  grid.cell = 1;
  grid.outside = 10;
  grid.inside = -10;
  constexpr int blocks = 5;
  constexpr double plane = 18.3;
  for (int z = 0; z < blocks; ++z)
    for (int y = 0; y < blocks; ++y)
      for (int x = 0; x < blocks; ++x) {
        Block block;
        block.at = {x, y, z};
        block.field = static_cast<std::uint32_t>(grid.blocks.size());
        grid.blocks.push_back(block);
      }
  grid.index.reset(grid.blocks.size());
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) grid.index.insert(key_of(grid.blocks[b].at), b);
  for (Block& block : grid.blocks)
    for (int o = 0; o < 8; ++o)
      block.plus[std::size_t(o)] = grid.index.find(key_of(block.at + Int3{o & 1, o >> 1 & 1, o >> 2}));
  grid.values.resize(grid.blocks.size() * nodes);
  grid.inside_bits.resize(grid.blocks.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) {
      for (int node = 0; node < nodes; ++node)
        grid.values[std::size_t(b) * nodes + std::size_t(node)] =
            float(grid.place({b, node})[Eigen::Index(axis)] - plane);
      grid.find_inside(b);
    }
    const CubeLattice lattice(grid, std::vector<std::uint8_t>(grid.blocks.size(), 1));
    for (const double deviation : {1.2, 1.5, 3.0, 4.5}) {
      const NodeValues shares =
          inside_shares(inside_parts(grid, lattice, Workers(2)), deviation, grid, lattice, Workers(2));
      for (std::size_t n = 0; n < lattice.size(); ++n)
        for (int node = 0; node < nodes; ++node) {
          const Vec3 x = grid.place({lattice.block(n), node});
          // Beyond the grid all is outside.
          if ((x.array() < 4 * deviation).any() || (x.array() > 8 * blocks - 1 - 4 * deviation).any())
            continue;
          const double depth = (plane - x[Eigen::Index(axis)]) / deviation;
          ASSERT_NEAR(shares[n][std::size_t(node)], 0.5 * std::erfc(-depth / std::sqrt(2.0)), 0.02)
              << deviation << " at " << depth;
        }
    }
  }
}

}  // namespace
}  // namespace oilskin
