// The mesh without obstacles: volumes, closedness of every field, moved input, quantities on vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"

namespace oilskin {
namespace {

using test::WaterScene;

ReconstructionOptions plain(double spacing, double cell = 0.5) {
  ReconstructionOptions o;
  o.spacing = spacing;
  o.cell = cell;
  o.threads = 2;
  return o;
}

WaterScene block(int n, double jitter, double spacing = 0.005) {
  WaterScene s;
  s.spacing = spacing;
  s.add_water({Vec3::Zero(), Vec3::Constant(n * spacing)}, jitter, 21);
  return s;
}

TEST(Field, one_particle_is_a_ball_of_its_radius) {
  const std::vector<Vec3> one = {Vec3(0.123, -4.56, 7.89)};
  ReconstructionInput input;
  input.positions = one;
  for (double radius : {0.3, 0.5, 0.7}) {
    ReconstructionOptions options = plain(0.01, 0.1);
    options.particle_radius = radius;
    options.keep_volume = false;  // the field's own shape
    const WaterMesh mesh = test::reconstruct(input, options);
    test::expect_closed(check_mesh(mesh, {}, 0));
    ASSERT_GT(mesh.positions.size(), 50u);
    for (const auto& p : mesh.positions)
      EXPECT_NEAR((Vec3(p[0], p[1], p[2]) - one[0]).norm(), radius * 0.01, 0.02 * 0.01);
    // Vertices on the ball, triangles within: of three cells radius, 7 % less.
    const double ball = 4.18879 * std::pow(radius * 0.01, 3), volume = check_mesh(mesh, {}, 0).volume;
    EXPECT_LT(volume, ball);
    EXPECT_GT(volume, 0.92 * ball);
  }
}

TEST(Field, a_full_block_has_its_volume) {
  for (double jitter : {0.0, 0.2})
    for (double cell : {0.5, 0.8}) {
      const WaterScene s = block(16, jitter);
      ReconstructionReport report;
      const WaterMesh mesh = test::reconstruct(s.input(), plain(s.spacing, cell), &report);
      const double full = std::pow(16 * s.spacing, 3);
      EXPECT_NEAR(report.volume, full, 0.05 * full) << jitter << " " << cell;
      const MeshCheck check = check_mesh(mesh, {}, 0);
      test::expect_closed(check);
      EXPECT_EQ(check.components, 1u) << "no bubbles, no blobs";
      EXPECT_NEAR(check.volume, report.volume, 1e-6 * full);
    }
}

TEST(Field, every_field_gives_a_closed_mesh_of_about_the_same_water) {
  WaterScene s = block(12, 0.3);
  test::Random random(22);
  for (int drop = 0; drop < 150; ++drop) s.particles.push_back(Vec3::Constant(0.03) + random.in_cube(0.06));
  std::vector<double> volumes;
  for (const ReconstructionField field :
       {ReconstructionField::density_decay, ReconstructionField::eigenvalue_decay,
        ReconstructionField::zhu_bridson, ReconstructionField::density}) {
    ReconstructionOptions options = plain(s.spacing);
    options.field = field;
    options.keep_volume = false;
    const MeshCheck check = check_mesh(test::reconstruct(s.input(), options), {}, 0);
    test::expect_closed(check);
    volumes.push_back(check.volume);
  }
  EXPECT_LT(*std::max_element(volumes.begin(), volumes.end()),
            1.5 * *std::min_element(volumes.begin(), volumes.end()));
  EXPECT_LT(volumes[1], volumes[2]) << "the decay takes blobs away";
}

TEST(Field, two_bodies_two_spacings_apart_are_not_joined_by_a_skin) {
  WaterScene s = block(10, 0.1);
  WaterScene other = block(10, 0.1);
  for (const Vec3& p : other.particles) s.particles.push_back(p + Vec3(12 * s.spacing, 0, 0));
  ReconstructionOptions options = plain(s.spacing);
  EXPECT_EQ(check_mesh(test::reconstruct(s.input(), options), {}, 0).components, 2u);
  options.field = ReconstructionField::zhu_bridson;
  const WaterMesh blobs = test::reconstruct(s.input(), options);
  const double middle = 11 * s.spacing;
  const auto in_gap = [&](const auto& p) { return std::abs(p[0] - middle) < 0.3 * s.spacing; };
  EXPECT_GT(std::count_if(blobs.positions.begin(), blobs.positions.end(), in_gap), 0) << "the known artefact";
}

/// Vertices in an order that does not depend on blocks.
std::vector<std::array<float, 3>> sorted(const WaterMesh& mesh) {
  std::vector<std::array<float, 3>> p = mesh.positions;
  std::sort(p.begin(), p.end());
  return p;
}

TEST(Field, moved_by_cells_the_mesh_is_the_same_one_moved) {
  WaterScene s = block(9, 0.3, 0.0625);
  for (Vec3& p : s.particles)  // few bits, so that sums with the move are exact
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * 0x1p14) * 0x1p-14;
  ReconstructionOptions options = plain(s.spacing);
  options.keep_volume = false;  // it is averaged over cubes of four cells
  const WaterMesh mesh = test::reconstruct(s.input(), options);
  const double h = 0.5 * s.spacing;
  {
    WaterScene moved = s;  // by whole blocks: the same bits
    const Vec3 displacement(8 * h * 3, -8 * h * 2, 8 * h);
    for (Vec3& p : moved.particles) p += displacement;
    const WaterMesh other = test::reconstruct(moved.input(), options);
    EXPECT_EQ(other.triangles, mesh.triangles);
    ASSERT_EQ(other.positions.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(other.positions[v][k], mesh.positions[v][k] + displacement[int(k)], 1e-6);
  }
  WaterScene moved = s;  // by cells
  const Vec3 displacement(3 * h, 5 * h, -6 * h);
  for (Vec3& p : moved.particles) p += displacement;
  WaterMesh other = test::reconstruct(moved.input(), options);
  ASSERT_EQ(other.triangles.size(), mesh.triangles.size());
  for (auto& p : other.positions)
    for (std::size_t k = 0; k < 3; ++k) p[k] = float(p[k] - displacement[int(k)]);
  // Vertices lie on grid lines, hence two of their coordinates are equal to the last bit or nearly; compare
  // sums.
  const auto a = sorted(mesh), b = sorted(other);
  ASSERT_EQ(a.size(), b.size());
  double sum_a = 0, sum_b = 0;
  for (std::size_t v = 0; v < a.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      sum_a += a[v][k] * double(k + 1);
      sum_b += b[v][k] * double(k + 1);
    }
  EXPECT_NEAR(sum_a, sum_b, 1e-6 * double(a.size()));
}

TEST(Field, deep_water_is_solid_and_a_hole_in_it_is_not_filled) {
  WaterScene s;
  const Vec3 middle = Vec3::Constant(18 * s.spacing);
  s.add_water({Vec3::Zero(), Vec3::Constant(36 * s.spacing)}, 0.2, 23,
              [&](const Vec3& p) { return (p - middle).norm() > 3 * s.spacing; });
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(s.input(), plain(s.spacing), &report);
  const MeshCheck check = check_mesh(mesh, {}, 0);
  test::expect_closed(check);
  EXPECT_EQ(check.components, 2u) << "the outside and the hole";
  EXPECT_LT(report.blocks, 1331u) << "fewer than the 11³ that the particles reach";
}

TEST(Field, the_clip_box_closes_the_mesh_along_its_sides) {
  const WaterScene s = block(14, 0.2);
  ReconstructionOptions options = plain(s.spacing);
  options.clip = Box{Vec3(0.021, -1, 0.0142), Vec3(0.0437, 1, 1)};
  for (int smoothing : {0, 4}) {
    options.smoothing_iterations = smoothing;
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    const MeshCheck check = check_mesh(mesh, {}, 0);
    test::expect_closed(check);
    Box box;
    for (const auto& p : mesh.positions) box.add(Vec3(p[0], p[1], p[2]));
    EXPECT_NEAR(box.min.x(), 0.021, 1e-6);
    EXPECT_NEAR(box.max.x(), 0.0437, 1e-6);
    EXPECT_NEAR(box.min.z(), 0.0142, 1e-6);
    EXPECT_NEAR(check.volume, (0.0437 - 0.021) * 0.07 * (0.07 - 0.0142), 0.06 * check.volume);
  }
}

TEST(Field, stray_drops_are_removed_whole_and_the_rest_stays) {
  WaterScene s = block(10, 0.2);
  ReconstructionOptions without = plain(s.spacing);
  without.keep_volume = false;
  const WaterMesh alone = test::reconstruct(s.input(), without);
  for (int k = 0; k < 5; ++k) s.particles.push_back(Vec3(0.1 + 0.03 * k, 0.02, 0.02));
  ReconstructionOptions options = plain(s.spacing);
  options.keep_volume = false;  // drops of the grid; those drawn apart are in volume_test.cpp
  EXPECT_EQ(check_mesh(test::reconstruct(s.input(), options), {}, 0).components, 6u);
  options.min_blob = 2;
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(s.input(), options, &report);
  EXPECT_EQ(report.blobs_removed, 5u);
  EXPECT_EQ(mesh.positions, alone.positions);
  EXPECT_EQ(mesh.triangles, alone.triangles);
}

TEST(Field, smoothing_takes_bumps_and_leaves_the_volume) {
  const WaterScene s = block(14, 0.4);
  ReconstructionOptions options = plain(s.spacing);
  ReconstructionReport before, after;
  const WaterMesh rough = test::reconstruct(s.input(), options, &before);
  options.smoothing_iterations = 40;
  const WaterMesh smooth = test::reconstruct(s.input(), options, &after);
  EXPECT_EQ(rough.triangles, smooth.triangles);
  EXPECT_NEAR(after.volume, before.volume, 0.01 * before.volume);
  // Bumps in the middle of the top: angles between the normals of neighbouring vertices.
  const auto roughness = [&s](const WaterMesh& m) {
    double sum = 0;
    int count = 0;
    for (const Triangle& t : m.triangles) {
      const auto n = [&](std::uint32_t v) { return Vec3(m.normals[v][0], m.normals[v][1], m.normals[v][2]); };
      const auto& p = m.positions[t[0]];
      const auto in = [&s](float x) { return x > 3 * s.spacing && x < 11 * s.spacing; };
      if (!in(p[0]) || !in(p[1]) || p[2] < 12 * s.spacing) continue;
      sum += 1 - n(t[0]).dot(n(t[1]));
      ++count;
    }
    EXPECT_GT(count, 100);
    return sum / count;
  };
  EXPECT_LT(roughness(smooth), 0.65 * roughness(rough));
}

TEST(VertexData, normals_are_unit_and_look_outward) {
  const WaterScene s = block(8, 0.1);
  const WaterMesh mesh = test::reconstruct(s.input(), plain(s.spacing));
  const Vec3 middle = Vec3::Constant(4 * s.spacing);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 n(mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]);
    const Vec3 p(mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]);
    EXPECT_NEAR(n.norm(), 1, 1e-5);
    EXPECT_GT(n.dot(p - middle), 0);
  }
}

TEST(VertexData, the_nearest_particle_is_that_of_brute_force) {
  const WaterScene s = block(6, 0.25);
  ReconstructionOptions options = plain(s.spacing);
  EXPECT_TRUE(test::reconstruct(s.input(), options).nearest.empty());
  options.nearest = true;
  const WaterMesh mesh = test::reconstruct(s.input(), options);
  ASSERT_EQ(mesh.nearest.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p(mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]);
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& q : s.particles) least = std::min(least, (q - p).norm());
    ASSERT_LT(mesh.nearest[v], s.particles.size());
    // The offsets are floats in units of a cell.
    EXPECT_NEAR((s.particles[mesh.nearest[v]] - p).norm(), least, 1e-5 * s.spacing);
  }
}

TEST(VertexData, a_linear_field_comes_out_linear_and_a_constant_one_constant) {
  const WaterScene s = block(12, 0.25);
  const Vec3 slope(3, -2, 5);
  std::vector<float> values;
  std::vector<Vec3> velocities;
  for (const Vec3& p : s.particles) {
    values.insert(values.end(), {float(slope.dot(p)), 7.0f});
    velocities.push_back(Vec3(p.y(), -p.x(), 1));
  }
  ReconstructionInput input = s.input();
  input.attributes.push_back({values, 2});
  input.velocities = velocities;
  const WaterMesh mesh = test::reconstruct(input, plain(s.spacing));
  ASSERT_EQ(mesh.attributes.size(), 1u);
  ASSERT_EQ(mesh.attributes[0].components, 2);
  ASSERT_EQ(mesh.attributes[0].values.size(), 2 * mesh.positions.size());
  ASSERT_EQ(mesh.velocities.size(), mesh.positions.size());
  double error = 0, worst = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p(mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]);
    const double e = std::abs(mesh.attributes[0].values[2 * v] - slope.dot(p)) / (slope.norm() * s.spacing);
    error += e;
    worst = std::max(worst, e);
    EXPECT_NEAR(mesh.attributes[0].values[2 * v + 1], 7, 1e-5);
    EXPECT_NEAR(mesh.velocities[v][0], p.y(), 0.3 * s.spacing);
    EXPECT_NEAR(mesh.velocities[v][1], -p.x(), 0.3 * s.spacing);
  }
  EXPECT_LT(error / double(mesh.positions.size()), 0.03) << "of a spacing's change";
  EXPECT_LT(worst, 0.35);
}

}  // namespace
}  // namespace oilskin
