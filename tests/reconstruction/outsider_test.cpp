// What somebody else's library says: FCL collides the water's mesh with the sheet, and finds nothing.
#include <fcl/fcl.h>
#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/runs.h"
#include "reconstruction/scenes.h"

namespace oilskin {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

template <class Vertex>
void fill(Model& model, const std::vector<Vertex>& vertices, const std::vector<Triangle>& triangles) {
  std::vector<fcl::Vector3<double>> points;
  for (const Vertex& v : vertices) points.emplace_back(v[0], v[1], v[2]);
  std::vector<fcl::Triangle> faces;
  for (const Triangle& t : triangles) faces.emplace_back(t[0], t[1], t[2]);
  model.beginModel();
  model.addSubModel(points, faces);
  model.endModel();
}

/// Pairs of triangles that FCL finds in contact, up to 1000.
std::size_t colliding_pairs(const WaterMesh& mesh, const test::WaterScene& scene) {
  Model water, sheet;
  fill(water, mesh.positions, mesh.triangles);
  fill(sheet, scene.vertices, scene.triangles);
  const fcl::CollisionRequest<double> request(1000, true);
  fcl::CollisionResult<double> result;
  const auto here = fcl::Transform3<double>::Identity();
  return fcl::collide(&water, here, &sheet, here, request, result);
}

class Outsider : public testing::TestWithParam<ObstacleMode> {};

TEST_P(Outsider, finds_no_triangle_of_the_water_in_a_sheet) {
  for (test::WaterScene scene :
       {test::wavy_scene(true), test::wavy_scene(false), test::vee_scene(), test::crumple_scene()}) {
    // Wet patches in dry cloth, of some cells each.
    scene.wet([](const Vec3& x) { return 0.5 + 0.5 * std::sin(300 * x.x()) * std::sin(300 * x.y()); });
    for (const double cell : {0.5, 0.8}) {
      ReconstructionOptions options;
      options.spacing = scene.spacing;
      options.cell = cell;
      options.contact = GetParam();
      options.smoothing_iterations = 4;
      options.threads = 2;
      EXPECT_EQ(colliding_pairs(test::reconstruct(scene.input(), options), scene), 0u) << cell;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, Outsider,
                         testing::Values(ObstacleMode::gap, ObstacleMode::touch, ObstacleMode::wet));

TEST(OutsiderCheck, finds_hundreds_where_the_sheet_is_ignored) {
  const test::WaterScene scene = test::wavy_scene(false);
  ReconstructionOptions options;
  options.spacing = scene.spacing;
  options.contact = ObstacleMode::none;
  options.threads = 2;
  EXPECT_GT(colliding_pairs(test::reconstruct(scene.input(), options), scene), 100u);
}

}  // namespace
}  // namespace oilskin
