// Which triangles the cells of the fluid list, against all pairs.
#include "fluid/triangle_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/closest_point.h"
#include "support/random.h"
#include "support/surface_of.h"

namespace oilskin::fluid {
namespace {

constexpr double h = 0.01;

/// Two sheets, one of them crumpled, and particles in the space around them.
struct Scene {
  std::vector<SurfaceMotion> surfaces;
  std::vector<MeshTopology> topologies;
  std::vector<Vec3> x;
  Neighbours neighbours;
  Workers workers;
  TriangleCells cells;

  Scene(int threads, unsigned seed, std::size_t particles, double extent) : workers(threads) {
    test::Random random(seed);
    for (const double bump : {0.0, 0.02}) {
      test::StaticMesh mesh;
      mesh.add_rectangle(Vec3(0, bump, 0), Vec3(0.1, 0, 0), Vec3(0, 0.03, 0.1), 20, 20);
      for (Vec3& node : mesh.nodes) node += random.in_cube(0.3 * bump);
      mesh.add_rectangle(Vec3(-0.1, -0.02, -0.1), Vec3(0.3, 0, 0), Vec3(0, 0, 0.3));  // larger than cells
      surfaces.push_back(test::surface_of(mesh, 0, surfaces.size() + 1));
      topologies.emplace_back(mesh.triangles, mesh.nodes.size());
    }
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < particles; ++k)
      places.push_back(Vec3(0.05, 0.02, 0.05) + random.in_cube(extent));
    for (const std::uint32_t i : neighbours.cell_order(places, h, workers)) x.push_back(places[i]);
    neighbours.search(x, workers);
    find({});
  }
  void find(Span<const TriangleList> near) {
    std::vector<SurfaceMotion*> motions;
    std::vector<const MeshTopology*> of;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      motions.push_back(&surfaces[s]);
      of.push_back(&topologies[s]);
    }
    cells.find(x, motions, of, near, h, neighbours, workers);
  }
  /// The triangles that the list of the particle's cell has, as pairs of surface and triangle.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> listed(std::uint32_t particle) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const TriangleCells::Cell& cell : cells.cells())
      if (cell.begin <= particle && particle < cell.end)
        for (const std::uint32_t t : cells.triangles_of(cell))
          found.emplace_back(cells.triangles()[t].surface, cells.triangles()[t].triangle);
    return found;
  }
};

TEST(TriangleCells, list_every_triangle_within_the_support_radius) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Scene scene(1, seed, 1500, 0.07);
    std::size_t near = 0, listed = 0, all = 0;
    for (std::uint32_t i = 0; i < scene.x.size(); ++i) {
      const auto found = scene.listed(i);
      EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
      listed += found.size();
      for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        const SurfaceMotion& m = scene.surfaces[s];
        all += m.triangles.size();
        for (std::uint32_t t = 0; t < m.triangles.size(); ++t) {
          const Triangle& n = m.triangles[t];
          if (closest_point(scene.x[i], m.x_t0[n[0]], m.x_t0[n[1]], m.x_t0[n[2]]).distance > h) continue;
          ++near;
          EXPECT_TRUE(std::binary_search(found.begin(), found.end(), std::make_pair(s, t)))
              << "particle " << i << ", surface " << s << ", triangle " << t;
        }
      }
    }
    EXPECT_GT(near, 5000u);
    EXPECT_LT(listed, all / 4) << "the lists are short";
  }
}

/// Which sides of the triangle have particles less than H from its plane, in cells near it.
TEST(TriangleCells, know_on_which_sides_particles_are) {
  Scene scene(1, 4, 400, 0.07);
  std::size_t one_sided = 0;
  for (const NearbyTriangle& t : scene.cells.triangles()) {
    const SurfaceMotion& m = scene.surfaces[t.surface];
    const Triangle& n = m.triangles[t.triangle];
    bool front = false, back = false;
    for (const Vec3& x : scene.x) {
      const ClosestPoint c = closest_point(x, m.x_t0[n[0]], m.x_t0[n[1]], m.x_t0[n[2]]);
      if (c.distance > h) continue;
      front |= t.cross.dot(x - m.x_t0[n[0]]) >= 0;
      back |= t.cross.dot(x - m.x_t0[n[0]]) <= 0;
    }
    EXPECT_TRUE(t.sides.front || !front);
    EXPECT_TRUE(t.sides.back || !back);
    one_sided += t.sides.front != t.sides.back;
  }
  EXPECT_GT(one_sided, 10u);
}

TEST(TriangleCells, are_the_same_on_two_threads) {
  const Scene one(1, 5, 3000, 0.07), two(2, 5, 3000, 0.07);
  ASSERT_EQ(one.cells.cells().size(), two.cells.cells().size());
  for (std::size_t c = 0; c < one.cells.cells().size(); ++c) {
    const auto a = one.cells.triangles_of(one.cells.cells()[c]),
               b = two.cells.triangles_of(two.cells.cells()[c]);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << "cell " << c;
  }
}

TEST(TriangleCells, list_nothing_where_nothing_is) {
  const Scene none(1, 6, 0, 0.07);
  EXPECT_TRUE(none.cells.is_found());
  EXPECT_TRUE(none.cells.cells().empty());
  Scene far(1, 6, 100, 0.01);
  for (Vec3& x : far.x) x += Vec3(7, 0, 0);
  const std::vector<Vec3> moved = far.x;
  far.x.clear();
  for (const std::uint32_t i : far.neighbours.cell_order(moved, h, far.workers)) far.x.push_back(moved[i]);
  far.neighbours.search(far.x, far.workers);
  far.find({});
  EXPECT_TRUE(far.cells.cells().empty());
  far.cells.clear();
  EXPECT_FALSE(far.cells.is_found());
}

}  // namespace
}  // namespace oilskin::fluid
