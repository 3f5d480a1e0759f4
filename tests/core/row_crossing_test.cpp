#include "core/row_crossing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/random.h"

namespace oilskin {
namespace {

struct Cube {
  std::vector<Vec3> nodes;
  std::vector<Triangle> triangles;

  /// Adds the cube of edge 2 around `center`, normals outwards.
  void add(const Vec3& center) {
    const auto first = static_cast<std::uint32_t>(nodes.size());
    for (int c = 0; c < 8; ++c)
      nodes.push_back(center + Vec3((c & 1) ? 1 : -1, (c & 2) ? 1 : -1, (c & 4) ? 1 : -1));
    const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : quads)
      for (const Triangle& t : {Triangle{q[0], q[1], q[2]}, Triangle{q[0], q[2], q[3]}})
        triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  int winds_round(const Vec3& x) const { return crossing_number(triangles, nodes, x); }
};

// Rows through diagonals, edges and nodes, too: points of a grid that has those of the cube.
TEST(RowCrossing, a_cube_winds_once_round_what_is_inside) {
  Cube cube;
  cube.add(Vec3::Zero());
  for (double x : {-1.5, -0.5, 0.0, 0.5, 1.5})
    for (double y : {-1.5, -0.5, 0.0, 0.25, 0.5, 1.5})
      for (double z : {-1.5, -0.5, 0.0, 0.5, 0.75, 1.5}) {
        const Vec3 p(x, y, z);
        EXPECT_EQ(cube.winds_round(p), p.cwiseAbs().maxCoeff() < 1 ? 1 : 0) << p.transpose();
      }
}

TEST(RowCrossing, rows_along_faces_and_edges_find_nothing_outside) {
  Cube cube;
  cube.add(Vec3::Zero());
  for (double x : {-3.0, 3.0})
    for (double y : {-1.0, 0.0, 1.0})
      for (double z : {-1.0, 0.0, 1.0}) EXPECT_EQ(cube.winds_round({x, y, z}), 0);
}

TEST(RowCrossing, a_turned_cube_and_cubes_that_overlap) {
  test::Random random(5);
  Cube cubes;
  cubes.add(Vec3::Zero());
  cubes.add(Vec3(0.5, 0.3, -0.4));
  const Eigen::Matrix3d turn = Eigen::AngleAxis<double>(1.1, random.direction()).toRotationMatrix();
  Cube turned = cubes;
  for (Vec3& n : turned.nodes) n = turn * n;
  int inside = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p = random.in_cube(2);
    const int expected =
        (p.cwiseAbs().maxCoeff() < 1) + ((p - Vec3(0.5, 0.3, -0.4)).cwiseAbs().maxCoeff() < 1);
    inside += expected > 0;
    EXPECT_EQ(turned.winds_round(turn * p), expected);
  }
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace oilskin
