#include "scene/cloth_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

Cloth grid(int nu, int nv) {
  Cloth cloth;
  cloth.grid = {nu, nv};
  cloth.size = {0.4, 0.2};
  return cloth;
}

TEST(ClothModel, the_papers_cloth_has_6272_faces_and_9520_links) {
  const ClothModel model = build_cloth(Cloth(), "cloth.0");
  EXPECT_EQ(model.rest.size(), 3249u);
  EXPECT_EQ(model.triangles.size(), 6272u);
  EXPECT_EQ(model.links.size(), 9520u);
  EXPECT_EQ((std::set<std::array<std::uint32_t, 2>>(model.links.begin(), model.links.end()).size()), 9520u);
}

TEST(ClothModel, nodes_run_along_the_u_axis_first_and_faces_look_along_the_normal) {
  const ClothModel model = build_cloth(grid(5, 3), "cloth.0");
  EXPECT_NEAR((model.rest[1] - model.rest[0]).dot(Vec3(1, 0, 0)), 0.1, 1e-15);
  for (const Triangle& t : model.triangles) {
    const Vec3 n = (model.rest[t[1]] - model.rest[t[0]]).cross(model.rest[t[2]] - model.rest[t[0]]);
    EXPECT_GT(n.dot(Vec3(0, 1, 0)), 0);
  }
}

TEST(ClothModel, mass_is_areal_density_times_area) {
  EXPECT_NEAR(build_cloth(grid(9, 7), "cloth.0").total_mass(), 0.2 * 0.4 * 0.2, 1e-15);
}

TEST(ClothModel, corners_are_three_by_three_nodes) {
  Cloth cloth = grid(9, 9);
  cloth.pins.kind = PinKind::corners;
  const ClothModel model = build_cloth(cloth, "cloth.0");
  int pinned = 0;
  for (const int g : model.pin_group) pinned += g != not_pinned;
  EXPECT_EQ(pinned, 36);
  EXPECT_NE(model.pin_group[0], not_pinned);
  EXPECT_EQ(model.pin_group[4 * 9 + 4], not_pinned);
}

TEST(ClothModel, a_bowl_is_deepest_in_the_middle_and_flat_at_its_rim) {
  Cloth cloth = grid(9, 9);
  cloth.bowl_depth = 0.15;
  const ClothModel model = build_cloth(cloth, "cloth.0");
  EXPECT_NEAR(model.rest[4 * 9 + 4].y(), -0.15, 1e-15);
  EXPECT_NEAR(model.rest[0].y(), 0, 1e-15);
  EXPECT_NEAR(model.rest[4].y(), 0, 1e-15);
}

TEST(ClothModel, a_mesh_vertex_without_area_is_refused) {
  Cloth cloth;
  cloth.mesh.emplace();
  cloth.mesh->mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(5, 5, 5)};
  cloth.mesh->mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(build_cloth(cloth, "cloth.0"), SceneError);
}

TEST(Motion, spins_about_its_axis_and_stops) {
  Motion motion;
  motion.spin_rate = 2;
  motion.velocity = Vec3(1, 0, 0);
  motion.start = 1;
  motion.stop = 2;
  const Vec3 x(1, 0, 0);
  EXPECT_EQ(moved(motion, x, 0.5), x);
  EXPECT_LT((moved(motion, x, 1.5) - Vec3(std::cos(1.0) + 0.5, 0, -std::sin(1.0))).norm(), 1e-14);
  EXPECT_EQ(moved(motion, x, 2), moved(motion, x, 9));
  const double e = 1e-6;
  const Vec3 difference = (moved(motion, x, 1.5 + e) - moved(motion, x, 1.5 - e)) / (2 * e);
  EXPECT_LT((velocity_at(motion, x, 1.5) - difference).norm(), 1e-8);
  EXPECT_EQ(velocity_at(motion, x, 2.5), Vec3(0, 0, 0));
}

}  // namespace
}  // namespace oilskin::demo
