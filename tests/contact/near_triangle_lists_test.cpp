// The lists of triangles near the fluid leave out no triangle that hidden neighbours and boundary terms need.
#include "contact/near_triangle_lists.h"

#include <gtest/gtest.h>

#include "core/closest_point.h"
#include "fluid/neighbours.h"
#include "support/random.h"
#include "support/surface_of.h"

namespace oilskin::contact {
namespace {

constexpr double support_radius = 0.01;  // H [m]

/// Drops of some particles, far from each other, and a sheet with hills that moves by `by` in the interval.
struct Scene {
  std::vector<Vec3> x;
  fluid::Neighbours neighbours;
  SurfaceMotion surface;
  SurfaceGeometry geometry;
  Workers workers{1};

  Scene(unsigned seed, const Vec3& by) {
    test::Random random(seed);
    for (int drop = 0; drop < 12; ++drop) {
      const Vec3 center(random.uniform(-0.05, 0.55), random.uniform(-0.03, 0.03),
                        random.uniform(-0.05, 0.55));
      for (int i = 0; i < 20; ++i) x.push_back(center + random.in_cube(0.012));
    }
    const std::vector<Vec3> given = x;
    const auto& order = neighbours.cell_order(given, support_radius, workers);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = given[order[i]];
    neighbours.search(x, workers);
    test::StaticMesh mesh;
    mesh.add_rectangle(Vec3::Zero(), Vec3(0.5, 0, 0), Vec3(0, 0, 0.5), 60, 60);
    for (Vec3& node : mesh.nodes) node.y() += 0.02 * (random.uniform() - 0.5);
    surface = test::surface_of(mesh);
    for (Vec3& node : surface.x_t1) node += by;
    geometry.analyse(surface);
    geometry.fit(surface, Workers(1));
  }
  double distance(const Vec3& p, std::uint32_t t) const {
    const Triangle& n = surface.triangles[t];
    return closest_point(p, surface.x_t0[n[0]], surface.x_t0[n[1]], surface.x_t0[n[2]]).distance;
  }
};

TEST(NearTriangleLists, hold_all_triangles_within_reach_and_few_others) {
  for (const Vec3& by : {Vec3(0, 0, 0), Vec3(0.02, 0.01, 0)}) {
    Scene scene(by.x() > 0 ? 1 : 2, by);
    const Workers workers(2);
    const std::vector<Box> boxes = scene.neighbours.boxes(scene.x, workers);
    NearTriangleLists lists;
    SurfaceGeometry* geometry[] = {&scene.geometry};
    const std::vector<std::uint32_t> list = lists.find(geometry, boxes, support_radius, workers)[0];
    EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
    EXPECT_EQ(std::adjacent_find(list.begin(), list.end()), list.end());
    EXPECT_LT(list.size(), scene.surface.triangles.size() / 3);
    std::size_t near = 0;
    for (std::uint32_t t = 0; t < scene.surface.triangles.size(); ++t) {
      const bool is_near = std::any_of(scene.x.begin(), scene.x.end(),
                                       [&](const Vec3& p) { return scene.distance(p, t) <= support_radius; });
      near += is_near ? 1 : 0;
      EXPECT_TRUE(!is_near || std::binary_search(list.begin(), list.end(), t)) << "triangle " << t;
    }
    EXPECT_GT(near, 100u);
    EXPECT_EQ(lists.find(geometry, boxes, support_radius, workers)[0], list)
        << "nothing is left from call to call";
    EXPECT_TRUE(lists.find(geometry, {}, support_radius, workers)[0].empty());
  }
}

TEST(NearTriangleLists, boxes_hold_all_particles_and_are_small) {
  const Scene scene(3, Vec3::Zero());
  const std::vector<Box> boxes = scene.neighbours.boxes(scene.x, Workers(2));
  for (const Vec3& x : scene.x)
    EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) { return b.contains(x); }));
  for (const Box& b : boxes) EXPECT_LE((b.max - b.min).maxCoeff(), 4.001 * support_radius);
  EXPECT_GT(boxes.size(), 5u);
}

}  // namespace
}  // namespace oilskin::contact
