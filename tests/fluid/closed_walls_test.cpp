// Closed walls: triangles that turn away from a particle are left out, but of cloth none is, which may pass
// through itself.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/boundary/visible_part.h"
#include "fluid/kernels.h"
#include "support/find_boundary.h"
#include "support/random.h"
#include "support/surface_of.h"

namespace oilskin::fluid {
namespace {

constexpr double support = 0.01;  // H [m]

/// place(u, v) on a grid that is closed in both directions.
template <class F>
test::StaticMesh closed_grid(std::uint32_t nu, std::uint32_t nv, const F& place) {
  test::StaticMesh mesh;
  for (std::uint32_t j = 0; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) mesh.nodes.push_back(place(2 * pi * i / nu, 2 * pi * j / nv));
  for (std::uint32_t j = 0; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) {
      const std::uint32_t a = i + nu * j, b = (i + 1) % nu + nu * j;
      const std::uint32_t c = i + nu * ((j + 1) % nv), d = (i + 1) % nu + nu * ((j + 1) % nv);
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

/// A ring with waves: convex outside, hollow inside, with edges of either kind.
test::StaticMesh ring(double radius, double tube, double waves) {
  return closed_grid(24, 10, [&](double u, double v) {
    const double r = tube * (1 + waves * std::cos(5 * u));
    return Vec3((radius + r * std::cos(v)) * std::cos(u), r * std::sin(v),
                (radius + r * std::cos(v)) * std::sin(u));
  });
}

test::StaticMesh block(const Vec3& size) {
  test::StaticMesh mesh;
  for (int k = 0; k < 8; ++k) mesh.nodes.push_back(size.cwiseProduct(Vec3(k & 1, k >> 1 & 1, k >> 2 & 1)));
  for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

/// Per particle; a point without walls where there are none.
std::vector<WallPoint> points_of(const test::StaticMesh& mesh, double inverse_mass,
                                 const std::vector<Vec3>& places, std::size_t* walls) {
  std::vector<Vec3> x = places;
  SurfaceMotion surface = test::surface_of(mesh, inverse_mass);
  SurfaceMotion* surfaces[] = {&surface};
  Boundary boundary{2.0};
  const std::vector<std::uint32_t> order =
      test::find_boundary(boundary, x, surfaces, {1.25e-4, support}, Workers(1));
  std::vector<WallPoint> points(x.size());
  for (const WallPoint& p : boundary.points()) points[order[p.particle]] = p;
  for (const WallPoint& p : points) *walls += p.end - p.begin;
  return points;
}

double distance(const test::StaticMesh& mesh, const Vec3& x) {
  double least = support;
  for (const Triangle& t : mesh.triangles)
    least = std::min(least, closest_point(x, mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]]).distance);
  return least;
}

struct Shape {
  const char* name;
  test::StaticMesh mesh;
};

TEST(ClosedWalls, act_as_cloth_of_the_same_triangles) {
  const Shape shapes[] = {{"ring", ring(0.02, 0.006, 0)},
                          {"waves", ring(0.015, 0.006, 0.4)},
                          {"thin ring", ring(0.004, 0.002, 0.2)},
                          {"block", block(Vec3(0.006, 0.02, 0.01))},
                          {"plate", block(Vec3(0.03, 0.001, 0.03))}};
  test::Random random(12);
  for (const Shape& shape : shapes) {
    std::vector<Vec3> x;  // outside and inside
    while (x.size() < 400) {
      const Vec3& node = shape.mesh.nodes[random.below(static_cast<std::uint32_t>(shape.mesh.nodes.size()))];
      const Vec3 place = node + random.uniform(0, 0.8 * support) * random.direction();
      // Nearer ones see triangles edge-on, where the integral along an edge depends on how it is cut.
      if (distance(shape.mesh, place) > 0.08 * support) x.push_back(place);
    }
    std::size_t walls = 0, walls_of_cloth = 0, near = 0;
    const std::vector<WallPoint> closed = points_of(shape.mesh, 0, x, &walls);
    const std::vector<WallPoint> cloth = points_of(shape.mesh, 1, x, &walls_of_cloth);
    for (std::size_t k = 0; k < x.size(); ++k) {
      near += cloth[k].lambda > 0.05f;
      EXPECT_NEAR(closed[k].lambda, cloth[k].lambda, 3e-4) << shape.name << ", particle " << k;
      EXPECT_LT((closed[k].gamma - cloth[k].gamma).norm(), 1e-3) << shape.name << ", particle " << k;
    }
    EXPECT_GT(near, 100u) << shape.name;
    EXPECT_LE(walls, walls_of_cloth) << shape.name;
  }
}

/// Of a ball of radius 1: 12 belts of 16 sides.
std::vector<std::array<Vec3, 3>> faces_of_ball() {
  const auto at = [](int i, int j) {
    const double u = 2 * pi * i / 16, v = pi * j / 12;
    return Vec3(std::sin(v) * std::cos(u), std::cos(v), std::sin(v) * std::sin(u));
  };
  std::vector<std::array<Vec3, 3>> faces;
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 16; ++i) {
      if (j > 0) faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (j < 11) faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return faces;
}

// From outside no face of a ball that is seen hides a part of another, wherever the particle is.
TEST(ClosedWalls, faces_of_a_ball_that_are_seen_hide_nothing) {
  test::Random random(13);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 particle = random.uniform(1.1, 1.8) * random.direction();
    VisibleParts seen, all;
    for (const std::array<Vec3, 3>& face : faces_of_ball()) {
      std::array<Eigen::Vector3f, 3> corners;
      for (std::size_t c = 0; c < 3; ++c) corners[c] = (face[c] - particle).cast<float>();
      const WallPlane plane(corners);
      const double outwards = plane.normal.cast<double>().dot(face[0] + face[1] + face[2]) > 0 ? 1 : -1;
      if (outwards * static_cast<double>(plane.offset) < -0.02) seen.add(corners);
      all.add(corners);
    }
    EXPECT_FALSE(seen.any_may_hide()) << "trial " << trial;
    EXPECT_TRUE(all.any_may_hide()) << "trial " << trial;
  }
}

}  // namespace
}  // namespace oilskin::fluid
