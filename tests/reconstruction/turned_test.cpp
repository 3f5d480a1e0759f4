// Triangles that face against the mesh around them (R.39). Marching cubes makes none. Smoothing beside
// obstacles, films and the fit of the volume move vertices past each other.
#include <gtest/gtest.h>

#include "reconstruction/promise.h"
#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"
#include "support/random.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::WaterScene;

/// The part of the area whose triangles face against the mean of their corners' normals.
double part_turned(const WaterMesh& mesh) {
  double turned = 0, all = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = test::position(mesh, t[0]), b = test::position(mesh, t[1]), c = test::position(mesh, t[2]);
    const Vec3 area = (b - a).cross(c - a);
    Vec3 normal = Vec3::Zero();
    for (const std::uint32_t v : t)
      normal += Vec3(mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]);
    all += area.norm();
    if (area.dot(normal) < 0) turned += area.norm();
  }
  return all > 0 ? turned / all : 0;
}

struct Case {
  const char* name;
  ObstacleMode mode;
  double cell;
  int smoothing;
  bool keep_volume;
  double most;  ///< part of the area
};

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

class TurnedTriangles : public ::testing::TestWithParam<Case> {
 protected:
  void expect_few(const WaterScene& s) const {
    ReconstructionOptions options = test::options_for(s, GetParam().cell, 0, GetParam().mode);
    options.smoothing_iterations = GetParam().smoothing;
    options.keep_volume = GetParam().keep_volume;
    const WaterMesh mesh = test::reconstruct(s.input(), options);
    EXPECT_GT(mesh.triangles.size(), 1000u);
    const double turned = part_turned(mesh);
    test::record("part turned", turned);
    EXPECT_LT(turned, GetParam().most);
    test::expect_promise(s, mesh, options.gap);
  }
};

TEST_P(TurnedTriangles, at_a_wavy_sheet_are_few) {
  expect_few(test::wavy_scene(true));
}

TEST_P(TurnedTriangles, in_a_v_are_few) {
  expect_few(test::vee_scene());
}

TEST_P(TurnedTriangles, at_folds_are_few) {
  expect_few(test::crumple_scene());
}

/// Two thin rods at the sloping surface of water whose particles lie irregularly. The grid's films, which are
/// thicker than the water, enclose air between them; as thick as the water they do not.
WaterScene rods_scene(std::uint64_t seed) {
  constexpr double pi = 3.14159265358979323846, radius = 0.4;
  WaterScene s;
  s.spacing = 1;
  const auto add_rod = [&](double y, double z) {
    s.add_sheet(8, [&](double u, double v) {
      return Vec3(20 * v - 4, y + radius * std::cos(2 * pi * u), z + radius * std::sin(2 * pi * u));
    });
  };
  add_rod(3.92, 6.49);
  add_rod(5.12, 3.99);
  test::Random random(seed);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 12; ++k) {
        const Vec3 x(i + 0.5, j + 0.5, k + 0.5);
        if (x.y() >= 4 - 0.58 * (x.z() - 6)) continue;
        const Vec3 at = x + random.in_cube(0.25);
        const double to_rods =
            std::min(std::hypot(at.y() - 3.92, at.z() - 6.49), std::hypot(at.y() - 5.12, at.z() - 3.99));
        if (to_rods > radius + 0.3) s.particles.push_back(at);
      }
  return s;
}

TEST(TurnedPieces, between_rods_at_the_surface_are_removed) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8})
    for (const double cell : {0.5, 0.8, 1.0}) {
      const WaterScene s = rods_scene(seed);
      const WaterMesh mesh =
          test::reconstruct(s.input(), test::options_for(s, cell, 0.1, ObstacleMode::touch));
      const MeshCheck check = check_mesh(mesh, s.obstacles(), 0.1);
      test::expect_clean(check, 0.1);
      EXPECT_NEAR(check.volume, double(s.particles.size()), 0.05 * double(s.particles.size()));
    }
}

INSTANTIATE_TEST_SUITE_P(
    Modes, TurnedTriangles,
    ::testing::Values(Case{"touch", ObstacleMode::touch, 0.5, 10, true, 5e-4},
                      Case{"touch_without_smoothing", ObstacleMode::touch, 0.5, 0, true, 3e-4},
                      Case{"gap", ObstacleMode::gap, 0.5, 10, true, 9e-4},
                      Case{"gap_with_large_cells", ObstacleMode::gap, 0.8, 10, true, 8.5e-4},
                      Case{"gap_without_volume", ObstacleMode::gap, 0.5, 10, false, 4e-4}),
    case_name);

}  // namespace
}  // namespace oilskin
