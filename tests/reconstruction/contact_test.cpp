// The promise: no triangle of the water cuts an obstacle or comes nearer than the gap, and no piece of an
// obstacle lies inside the water. Checked by exact signs and long doubles, not by the library's predicates
// alone.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "reconstruction/promise.h"
#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"
#include "reconstruction/triangle_oracle.h"

namespace oilskin {
namespace {

using test::audit_pairs;
using test::expect_promise;
using test::options_for;
using test::PairAudit;
using test::WaterScene;

const WaterScene& scene(const std::string& name) {
  static const std::map<std::string, WaterScene> scenes = {{"both", test::wavy_scene(true)},
                                                           {"above", test::wavy_scene(false)},
                                                           {"vee", test::vee_scene()},
                                                           {"crumple", test::crumple_scene()}};
  return scenes.at(name);
}

struct Case {
  const char* scene;
  double cell, gap;
};

class Contact : public testing::TestWithParam<Case> {};

TEST_P(Contact, nothing_is_nearer_than_the_gap_and_nothing_is_submerged) {
  const WaterScene& s = scene(GetParam().scene);
  const double gap = GetParam().gap * s.spacing;
  const double unclipped =
      check_mesh(test::reconstruct(s.input(), options_for(s, GetParam().cell, 0, ObstacleMode::none)), {}, 0)
          .volume;
  for (const ObstacleMode contact : {ObstacleMode::gap, ObstacleMode::touch}) {
    ReconstructionOptions options = options_for(s, GetParam().cell, GetParam().gap, contact);
    ReconstructionReport report;
    const WaterMesh mesh = test::reconstruct(s.input(), options, &report);
    ASSERT_GT(mesh.triangles.size(), 500u);
    expect_promise(s, mesh, gap);
    RecordProperty(contact == ObstacleMode::gap ? "volume_of_gap" : "volume_of_touch",
                   std::to_string(report.volume / unclipped));
    EXPECT_GT(report.volume, 0.6 * unclipped);
    EXPECT_LT(report.volume, 1.1 * unclipped);

    options.smoothing_iterations = 6;
    const WaterMesh smooth = test::reconstruct(s.input(), options);
    expect_promise(s, smooth, gap);
    EXPECT_EQ(smooth.triangles, mesh.triangles);
    EXPECT_NE(smooth.positions, mesh.positions);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Contact,
                         testing::Values(Case{"both", 0.5, 0}, Case{"both", 0.8, 0.1}, Case{"both", 0.5, 0.4},
                                         Case{"above", 0.5, 0.1}, Case{"above", 0.8, 0},
                                         Case{"above", 0.8, 0.4}, Case{"vee", 0.5, 0}, Case{"vee", 0.8, 0.1},
                                         Case{"vee", 0.5, 0.4}, Case{"crumple", 0.5, 0.1},
                                         Case{"crumple", 0.8, 0}, Case{"crumple", 0.8, 0.4}),
                         [](const testing::TestParamInfo<Case>& parameter) {
                           return std::string(parameter.param.scene) + "_cell_" +
                                  std::to_string(int(10 * parameter.param.cell)) + "_gap_" +
                                  std::to_string(int(10 * parameter.param.gap));
                         });

TEST(ContactModes, without_contact_the_same_water_cuts_the_sheet_or_swallows_it) {
  for (const char* name : {"above", "vee"}) {
    const WaterScene& s = scene(name);
    const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, 0.5, 0, ObstacleMode::none));
    const MeshCheck check = check_mesh(mesh, s.obstacles(), 0);
    const PairAudit audit = audit_pairs(mesh, s.obstacles()[0], 1e-5);
    EXPECT_GT(audit.meeting, 100u) << name;
    // The library's count is the exact one, or a little more: it counts what it cannot show to be apart.
    EXPECT_GE(check.intersecting_pairs, audit.meeting) << name;
    EXPECT_LE(check.intersecting_pairs, audit.meeting + 3) << name;
    EXPECT_FALSE(check.clean());
  }
  // No pair is cut, and yet all of the sheet is in the water: the second half of the check sees it.
  const WaterScene& s = scene("both");
  const MeshCheck check =
      check_mesh(test::reconstruct(s.input(), options_for(s, 0.5, 0, ObstacleMode::none)), s.obstacles(), 0);
  EXPECT_EQ(check.intersecting_pairs, 0u);
  EXPECT_EQ(check.submerged_components, 1u);
}

TEST(ContactModes, the_paper_s_reset_leaves_intersections_at_a_small_distance_and_none_at_the_root_of_three) {
  const WaterScene& s = scene("crumple");
  ReconstructionOptions options = options_for(s, 0.8, 0, ObstacleMode::reset);
  EXPECT_GT(audit_pairs(test::reconstruct(s.input(), options), s.obstacles()[0], 1e-5).meeting, 20u);
  options = options_for(s, 0.5, 0.9, ObstacleMode::reset);  // √3 · 0.5 = 0.87
  ReconstructionReport provable;
  const WaterMesh mesh = test::reconstruct(s.input(), options, &provable);
  EXPECT_EQ(audit_pairs(mesh, s.obstacles()[0], 1e-5).meeting, 0u);
  ReconstructionReport gap;
  test::reconstruct(s.input(), options_for(s, 0.5, 0, ObstacleMode::gap), &gap);
  EXPECT_LT(provable.volume, 0.95 * gap.volume) << "what the provable distance costs";
}

TEST(ContactModes, on_a_plane_touch_makes_an_even_film_at_the_clearance) {
  WaterScene s;
  // Tilted, so that the grid sees it at all heights.
  const auto height = [](double x, double y) { return 0.31 * x + 0.17 * y; };
  s.add_sheet(3, [&](double u, double v) { return Vec3(0.1 * u, 0.1 * v, height(0.1 * u, 0.1 * v)); });
  s.add_water({Vec3(0.02, 0.02, 0), Vec3(0.08, 0.08, 0.08)}, 0.2, 9, [&](const Vec3& p) {
    const double above = p.z() - height(p.x(), p.y());
    return above > 0.001 && above < 0.016;
  });
  const Vec3 normal = Vec3(-0.31, -0.17, 1).normalized();
  for (double gap : {0.0, 0.1, 0.4}) {
    const ReconstructionOptions options = options_for(s, 0.5, gap, ObstacleMode::touch);
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    expect_promise(s, mesh, options.gap);
    // Under the middle of the water: all heights of the lower side.
    double low = 1e9, high = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 x(mesh.positions[v][0], mesh.positions[v][1], mesh.positions[v][2]);
      const Vec3 n(mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]);
      const Vec3 middle(0.05, 0.05, height(0.05, 0.05));
      if ((x - middle).norm() > 0.018 || n.dot(normal) > -0.7) continue;
      low = std::min(low, normal.dot(x));
      high = std::max(high, normal.dot(x));
    }
    // To a hundredth of a cell, which vertices keep from nodes; a little more where the water itself ends
    // near.
    const double cell = 0.5 * s.spacing;
    EXPECT_NEAR(low, options.gap + 0.15 * cell, 0.0101 * cell) << gap;
    EXPECT_NEAR(high, options.gap + 0.15 * cell, 0.02 * cell) << gap;
  }
}

TEST(ContactModes, overlap_goes_through_a_closed_body_by_the_depth) {
  WaterScene s;
  // A box of two triangles a side, water on its top.
  const Vec3 low(0.02, 0.02, 0.01), high(0.08, 0.08, 0.04);
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x)
        s.vertices.push_back(Vec3((x ? high : low).x(), (y ? high : low).y(), (z ? high : low).z()));
  s.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  s.add_water({Vec3(0.03, 0.03, 0.042), Vec3(0.07, 0.07, 0.06)}, 0.1, 11);
  for (double depth : {0.2, 0.8}) {
    ReconstructionOptions options = options_for(s, 0.5, 0, ObstacleMode::overlap);
    options.overlap_depth = depth * s.spacing;
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    test::expect_closed(check_mesh(mesh, {}, 0));
    double deepest = 1;
    for (const auto& p : mesh.positions) deepest = std::min(deepest, double(p[2]));
    EXPECT_NEAR(deepest, 0.04 - options.overlap_depth, 0.1 * s.spacing) << depth;
  }
}

TEST(ContactHard, a_sheet_exactly_in_a_plane_of_the_grid) {
  WaterScene s;
  s.spacing = 0.0078125;  // 2⁻⁷: planes of the grid are exact
  const double z = 8 * 0.5 * s.spacing;
  s.add_sheet(5, [&](double u, double v) { return Vec3(0.01 + 0.08 * u, 0.01 + 0.08 * v, z); });
  s.add_water({Vec3::Zero(), Vec3(0.1, 0.1, 0.06)}, 0.2, 12);
  s.push_off(0.2);
  for (double gap : {0.0, 0.3}) {
    const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, 0.5, gap, ObstacleMode::gap));
    expect_promise(s, mesh, gap * s.spacing);
  }
  // … and with vertices on nodes and edges on edges of the grid
  WaterScene t = s;
  t.vertices.clear();
  t.triangles.clear();
  t.add_sheet(5, [&](double u, double v) {
    const double h = 0.5 * s.spacing;
    return Vec3(h * std::round(4 + 15 * u), h * std::round(4 + 15 * v), z);
  });
  expect_promise(t, test::reconstruct(t.input(), options_for(t, 0.5, 0, ObstacleMode::touch)), 0);
}

TEST(ContactHard, two_layers_closer_than_a_cell_and_borders_within_the_water) {
  WaterScene s;
  for (double z : {0.03, 0.0315})
    s.add_sheet(9, [&](double u, double v) {
      return Vec3(0.03 + 0.05 * u, 0.03 + 0.05 * v, z + 0.004 * std::sin(70 * u) + 0.3 * 0.05 * v);
    });
  s.add_water({Vec3::Zero(), Vec3(0.1, 0.1, 0.07)}, 0.2, 13);
  s.push_off(0.2);
  for (double cell : {0.5, 0.8})
    for (double gap : {0.0, 0.1}) {
      const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, cell, gap, ObstacleMode::gap));
      expect_promise(s, mesh, gap * s.spacing);
    }
}

TEST(ContactHard, the_largest_gap_with_the_coarsest_cell_and_a_narrow_kernel) {
  const WaterScene& s = scene("both");
  ReconstructionOptions options = options_for(s, 1, 1, ObstacleMode::gap);
  options.kernel_radius = 1.5;
  expect_promise(s, test::reconstruct(s.input(), options), options.gap);
}

TEST(ContactHard, pieces_smaller_than_a_cell_do_not_stay_in_the_water) {
  WaterScene s;
  s.add_water({Vec3::Zero(), Vec3(0.06, 0.06, 0.06)}, 0.2, 14);
  test::Random random(15);
  for (int piece = 0; piece < 40; ++piece) {
    const Vec3 at = Vec3::Constant(0.03) + random.in_cube(0.025);
    const auto first = std::uint32_t(s.vertices.size());
    for (int k = 0; k < 3; ++k) s.vertices.push_back(at + random.in_cube(3e-4));
    if (piece % 4 == 0) s.vertices[first + 1] = s.vertices[first];  // a segment
    if (piece % 8 == 0) s.vertices[first + 2] = s.vertices[first];  // a point
    s.triangles.push_back({first, first + 1, first + 2});
  }
  ReconstructionReport report;
  const WaterMesh mesh = test::reconstruct(s.input(), options_for(s, 0.8, 0, ObstacleMode::gap), &report);
  EXPECT_GT(report.components_freed + report.nodes_cleared, 10u);
  expect_promise(s, mesh, 0);
}

TEST(ContactHard, random_triangles_huge_tiny_and_slivers) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    test::Random random(seed);
    WaterScene s;
    s.add_water({Vec3::Zero(), Vec3(0.05, 0.05, 0.05)}, random.uniform(0, 0.5), seed + 100);
    const int n = 1 + int(random.below(30));
    for (int t = 0; t < n; ++t) {
      const Vec3 at = Vec3::Constant(0.025) + random.in_cube(0.03);
      const double size = std::array<double, 4>{10, 0.03, 0.004, 1e-5}[random.below(4)];
      const auto first = std::uint32_t(s.vertices.size());
      for (int k = 0; k < 3; ++k) s.vertices.push_back(at + random.in_cube(size));
      switch (random.below(6)) {
        case 0:
          s.vertices[first + 2] = 0.5 * (s.vertices[first] + s.vertices[first + 1]);
          break;
        case 1:
          s.vertices[first + 2] = s.vertices[first + 1];
          break;
        case 2:
          s.vertices[first + 2] = s.vertices[first] + 1e-6 * (s.vertices[first + 1] - at);
          break;
        default:
          break;
      }
      s.triangles.push_back({first, first + 1, first + 2});
    }
    const double gap = std::array<double, 3>{0, 0.1, 0.4}[random.below(3)];
    ReconstructionOptions options = options_for(s, random.uniform(0.4, 1), gap,
                                                random.below(2) ? ObstacleMode::gap : ObstacleMode::touch);
    options.smoothing_iterations = int(random.below(2)) * 3;
    options.field = static_cast<ReconstructionField>(random.below(4));
    SCOPED_TRACE(seed);
    expect_promise(s, test::reconstruct(s.input(), options), gap * s.spacing);
    s.wet([&](const Vec3&) { return random.uniform(0, 1); });
    options.contact = ObstacleMode::wet;
    expect_promise(s, test::reconstruct(s.input(), options), gap * s.spacing);
  }
}

TEST(ContactDeterminism, one_two_and_four_threads_give_the_same_bits) {
  WaterScene s = scene("crumple");
  std::vector<Vec3> velocities;
  for (const Vec3& p : s.particles) velocities.push_back(Vec3(std::sin(40 * p.x()), p.y(), 3));
  ReconstructionInput input = s.input();
  input.velocities = velocities;
  WaterMesh first;
  for (int threads : {1, 2, 4}) {
    ReconstructionOptions options = options_for(s, 0.8, 0.1, ObstacleMode::touch);
    options.smoothing_iterations = 3;
    options.min_blob = 1;
    options.threads = threads;
    const WaterMesh mesh = test::reconstruct(input, options);
    if (threads == 1) {
      first = mesh;
      continue;
    }
    EXPECT_EQ(mesh.positions, first.positions);
    EXPECT_EQ(mesh.triangles, first.triangles);
    EXPECT_EQ(mesh.normals, first.normals);
    EXPECT_EQ(mesh.velocities, first.velocities);
  }
}

TEST(ContactAttributes, what_a_vertex_carries_comes_from_its_own_side_of_the_sheet) {
  WaterScene s;
  s.add_sheet(6, [](double u, double v) { return Vec3(-0.02 + 0.1 * u, -0.02 + 0.1 * v, 0.0301); });
  s.add_water({Vec3::Zero(), Vec3(0.06, 0.06, 0.06)}, 0.1, 16);
  s.push_off(0.2);
  std::vector<float> above;
  for (const Vec3& p : s.particles) above.push_back(p.z() > 0.0301 ? 1.0f : -1.0f);
  ReconstructionInput input = s.input();
  input.attributes.push_back({above, 1});
  ReconstructionOptions options = options_for(s, 0.5, 0, ObstacleMode::gap);
  options.nearest = true;
  const WaterMesh mesh = test::reconstruct(input, options);
  ASSERT_EQ(mesh.attributes[0].values.size(), mesh.positions.size());
  ASSERT_EQ(mesh.nearest.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const float own_side = mesh.positions[v][2] > 0.0301f ? 1.0f : -1.0f;
    ASSERT_EQ(mesh.attributes[0].values[v], own_side);
    ASSERT_LT(mesh.nearest[v], above.size());
    ASSERT_EQ(above[mesh.nearest[v]], own_side);
  }
}

}  // namespace
}  // namespace oilskin
