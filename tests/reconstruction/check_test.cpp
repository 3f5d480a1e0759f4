// The acceptance test of a mesh: it sees faults, and its counts are those of other routes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "oilskin/reconstruction.h"
#include "reconstruction/triangle_distance.h"
#include "support/random.h"

namespace oilskin {
namespace {

TEST(Check, sees_what_is_wrong_with_a_mesh) {
  WaterMesh box;  // a tetrahedron
  box.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  box.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_TRUE(check_mesh(box, {}, 0).clean());
  EXPECT_NEAR(check_mesh(box, {}, 0).volume, 1.0 / 6, 1e-12);
  EXPECT_EQ(check_mesh(box, {}, 0).components, 1u);

  WaterMesh open = box;
  open.triangles.pop_back();
  EXPECT_EQ(check_mesh(open, {}, 0).open_edges, 3u);
  WaterMesh turned = box;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_EQ(check_mesh(turned, {}, 0).misoriented_edges, 3u);
  WaterMesh crowded = box;
  crowded.triangles.push_back({0, 1, 3});
  EXPECT_EQ(check_mesh(crowded, {}, 0).crowded_edges, 3u);
  WaterMesh pinched = box;  // a second one on the same corner
  pinched.positions.insert(pinched.positions.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
  pinched.triangles.insert(pinched.triangles.end(), {{0, 5, 4}, {0, 4, 6}, {0, 6, 5}, {4, 5, 6}});
  EXPECT_EQ(check_mesh(pinched, {}, 0).pinched_vertices, 1u);
  EXPECT_EQ(check_mesh(pinched, {}, 0).open_edges, 0u);

  const auto with = [&](const std::vector<Vec3>& v, double gap) {
    const std::vector<Triangle> t = {{0, 1, 2}};
    const std::vector<ObstacleMesh> o = {{v, t}};
    return check_mesh(box, o, gap);
  };
  EXPECT_EQ(with({Vec3(0.1, 0.1, -1), Vec3(0.1, 0.1, 1), Vec3(0.2, 0.1, 1)}, 0).intersecting_pairs, 2u);
  EXPECT_EQ(with({Vec3(0.1, 0.1, 0.1), Vec3(0.2, 0.1, 0.1), Vec3(0.1, 0.2, 0.1)}, 0).submerged_components,
            1u);
  const MeshCheck near = with({Vec3(0.1, 0.1, -0.25), Vec3(0.2, 0.1, -0.25), Vec3(0.1, 0.2, -0.25)}, 0.5);
  EXPECT_EQ(near.intersecting_pairs, 0u);
  EXPECT_EQ(near.too_close_pairs, 3u);
  EXPECT_NEAR(near.min_distance, 0.25, 1e-13);
  EXPECT_LE(near.min_distance, 0.25);
  EXPECT_TRUE(with({Vec3(0.1, 0.1, -0.25), Vec3(0.2, 0.1, -0.25), Vec3(0.1, 0.2, -0.25)}, 0.2).clean());
}

/// The surface of a cube with half the edge `size`, inside out where `size` is negative.
void add_cube(const Vec3& center, float size, WaterMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t k = 0; k < 8; ++k)
    mesh.positions.push_back({float(center.x()) + (k & 1 ? size : -size),
                              float(center.y()) + (k & 2 ? size : -size),
                              float(center.z()) + (k & 4 ? size : -size)});
  const std::array<std::array<std::uint32_t, 4>, 6> faces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

TEST(Check, counts_pieces_that_are_inside_out_but_no_bubbles) {
  WaterMesh mesh;
  add_cube(Vec3::Zero(), 1, mesh);
  EXPECT_NEAR(check_mesh(mesh, {}, 0).volume, 8, 1e-6);
  add_cube(Vec3(0.3, 0.2, 0.1), -0.25f, mesh);  // a bubble
  EXPECT_NEAR(check_mesh(mesh, {}, 0).volume, 8 - 0.125, 1e-6);
  EXPECT_TRUE(check_mesh(mesh, {}, 0).clean());
  add_cube(Vec3(0.3, 0.2, 0.1), 0.125f, mesh);  // a drop in it
  EXPECT_TRUE(check_mesh(mesh, {}, 0).clean());
  add_cube(Vec3(0.9, 0, 0), -0.05f, mesh);  // a bubble at the side
  EXPECT_EQ(check_mesh(mesh, {}, 0).turned_components, 0u);
  // Above, below and beside the water; below, where vertical lines from it pass through edges and corners.
  for (const Vec3& at : {Vec3(0.2, 0.1, 1.5), Vec3(0.2, 0.1, -1.5), Vec3(3, 0, 0), Vec3(0, 0, -3)}) {
    WaterMesh turned = mesh;
    add_cube(at, -0.25f, turned);
    EXPECT_EQ(check_mesh(turned, {}, 0).turned_components, 1u) << at.transpose();
    EXPECT_FALSE(check_mesh(turned, {}, 0).clean());
  }
  WaterMesh alone;
  add_cube(Vec3::Zero(), -1, alone);
  EXPECT_EQ(check_mesh(alone, {}, 0).turned_components, 1u);
}

TEST(Check, does_not_depend_on_the_numbers_of_vertices) {
  // A tetrahedron without a face, and a triangle on one of its corners.
  WaterMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {1e6f, 0, 0}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {0, 4, 5}};
  std::array<std::uint32_t, 7> number = {0, 1, 2, 3, 4, 5, 6};
  do {
    WaterMesh other = mesh;
    for (std::uint32_t v = 0; v < number.size(); ++v) other.positions[number[v]] = mesh.positions[v];
    for (Triangle& t : other.triangles) t = {number[t[0]], number[t[1]], number[t[2]]};
    const MeshCheck check = check_mesh(other, {}, 0, 1);
    ASSERT_EQ(check.pinched_vertices, 1u);
    ASSERT_EQ(check.open_edges, 6u);
  } while (std::next_permutation(number.begin(), number.end()));
}

TEST(Check, takes_no_notice_of_unused_vertices) {
  WaterMesh box;
  box.positions = {{1e7f, 1e7f, 1e7f}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  box.triangles = {{1, 3, 2}, {1, 2, 4}, {1, 4, 3}, {2, 3, 4}};
  EXPECT_NEAR(check_mesh(box, {}, 0).volume, 1.0 / 6, 1e-12);
  const std::vector<Vec3> beside = {Vec3(-1, 0, 0), Vec3(-1, 1, 0), Vec3(-1, 0, 1)};
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  const std::vector<ObstacleMesh> obstacles = {{beside, triangles}};
  EXPECT_TRUE(std::isinf(check_mesh(box, obstacles, 0).min_distance))
      << "not within a thousandth of its extent";
}

TEST(Check, of_a_mesh_without_extent_has_a_distance) {
  WaterMesh point;
  point.positions = {{0.25f, 0.25f, 0}};
  point.triangles = {{0, 0, 0}};
  const std::vector<Vec3> vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  const std::vector<ObstacleMesh> obstacles = {{vertices, triangles}};
  const MeshCheck check = check_mesh(point, obstacles, 0);
  EXPECT_EQ(check.intersecting_pairs, 1u);
  EXPECT_EQ(check.min_distance, 0);
}

/// Triangles that share `vertices` places in a cube of `half` [m].
WaterMesh soup(std::uint64_t seed, std::uint32_t vertices, int triangles, double half) {
  test::Random random(seed);
  WaterMesh mesh;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const Eigen::Vector3f x = random.in_cube(half).cast<float>();
    mesh.positions.push_back({x[0], x[1], x[2]});
  }
  for (int t = 0; t < triangles; ++t)
    mesh.triangles.push_back({random.below(vertices), random.below(vertices), random.below(vertices)});
  return mesh;
}

TEST(Check, counts_edges_as_a_table_of_them_does) {
  std::size_t open = 0, crowded = 0, misoriented = 0;
  for (const std::uint32_t vertices : {12u, 40u, 9000u}) {  // the last needs several tasks
    const WaterMesh mesh = soup(vertices, vertices, vertices == 9000 ? 200000 : 30, 1);
    std::map<std::array<std::uint32_t, 2>, std::array<std::size_t, 2>> edges;  // in either direction
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        ++edges[{std::min(a, b), std::max(a, b)}][a > b];
      }
    MeshCheck expected;
    for (const auto& [edge, times] : edges) {
      expected.open_edges += times[0] + times[1] == 1;
      expected.crowded_edges += times[0] + times[1] > 2;
      expected.misoriented_edges += times[0] + times[1] == 2 && times[0] != 1;
    }
    for (const int threads : {1, 2}) {
      const MeshCheck check = check_mesh(mesh, {}, 0, threads);
      EXPECT_EQ(check.open_edges, expected.open_edges) << vertices;
      EXPECT_EQ(check.crowded_edges, expected.crowded_edges) << vertices;
      EXPECT_EQ(check.misoriented_edges, expected.misoriented_edges) << vertices;
    }
    open += expected.open_edges;
    crowded += expected.crowded_edges;
    misoriented += expected.misoriented_edges;
  }
  EXPECT_GT(open, 100u);
  EXPECT_GT(crowded, 10u);
  EXPECT_GT(misoriented, 10u);
}

/// Also where some pairs intersect: from then on no distance is below the least one.
TEST(Check, counts_pairs_as_all_of_them_asked_by_themselves_do) {
  std::size_t intersecting = 0, close = 0, near = 0, clean = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const double half = seed % 2 ? 1 : 0.2;
    const WaterMesh mesh = soup(seed, 30, 20, half);
    test::Random random(seed + 100);
    Box box;
    for (const auto& x : mesh.positions) box.add(Vec3(double(x[0]), double(x[1]), double(x[2])));
    const Vec3 beside = seed % 4 < 2 ? Vec3::Zero() : Vec3(2.02 * half, 0, 0);
    std::vector<Vec3> vertices;
    for (int v = 0; v < 24; ++v) vertices.push_back(beside + random.in_cube(half));
    std::vector<Triangle> triangles;
    for (std::uint32_t t = 0; t < 8; ++t) triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    for (const double gap : {0.0, 0.05 * half, 0.5 * half}) {
      std::size_t meeting = 0, too_close = 0;
      double least = std::numeric_limits<double>::infinity();
      const double reach = gap + 1e-3 * (box.max - box.min).maxCoeff();
      for (const Triangle& own : mesh.triangles)
        for (const Triangle& other : triangles) {
          reconstruction::Corners a, b;
          for (std::size_t k = 0; k < 3; ++k) {
            const auto& x = mesh.positions[own[k]];
            a[k] = Vec3(double(x[0]), double(x[1]), double(x[2]));
            b[k] = vertices[other[k]];
          }
          const double d = reconstruction::certified_distance(a, b);
          meeting += !(d > 0);
          too_close += !(d > gap);
          least = std::min(least, d);
        }
      const std::vector<ObstacleMesh> obstacles = {{vertices, triangles}};
      for (const int threads : {1, 2}) {
        const MeshCheck check = check_mesh(mesh, obstacles, gap, threads);
        EXPECT_EQ(check.intersecting_pairs, meeting) << seed;
        EXPECT_EQ(check.too_close_pairs, too_close) << seed;
        if (least < reach)
          EXPECT_EQ(check.min_distance, least) << seed;
        else
          EXPECT_TRUE(std::isinf(check.min_distance)) << seed;
      }
      intersecting += meeting;
      close += too_close > meeting;
      near += least < reach && meeting == 0;
      clean += too_close == 0;
    }
  }
  EXPECT_GT(intersecting, 100u);
  EXPECT_GT(close, 20u);
  EXPECT_GT(near, 10u);
  EXPECT_GT(clean, 10u);
}

}  // namespace
}  // namespace oilskin
