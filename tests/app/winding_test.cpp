// Winding numbers of grid points: against solid angles, which share nothing with rays.
#include "geometry/winding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/closest_point.h"

namespace oilskin::test {
namespace {

using Float3 = std::array<float, 3>;

struct Mesh {
  std::vector<Float3> positions;
  std::vector<Triangle> triangles;

  /// An octahedron, divided `levels` times and drawn onto an ellipsoid; `inwards` turns it.
  void add_ball(const Vec3& center, double radius, int levels, bool inwards) {
    const Vec3 axes[] = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    for (int octant = 0; octant < 8; ++octant) {
      Vec3 corner[3];
      for (int k = 0; k < 3; ++k) corner[k] = (octant >> k & 1 ? -1 : 1) * axes[k];
      const bool odd = ((octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1)) % 2 == 1;
      if (odd != inwards) std::swap(corner[1], corner[2]);
      divide(corner[0], corner[1], corner[2], levels, center, radius);
    }
  }
  double distance(const Vec3& x) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles)
      least = std::min(least, closest_point(x, corner(t[0]), corner(t[1]), corner(t[2])).distance);
    return least;
  }
  /// The solid angle of the mesh from x over that of a sphere [vanOosterom1983].
  double winding(const Vec3& x) const {
    double sum = 0;
    for (const Triangle& t : triangles) {
      Vec3 r[3];
      for (std::size_t k = 0; k < 3; ++k) r[k] = corner(t[k]) - x;
      const double l[3] = {r[0].norm(), r[1].norm(), r[2].norm()};
      sum += 2 * std::atan2(r[0].dot(r[1].cross(r[2])), l[0] * l[1] * l[2] + r[0].dot(r[1]) * l[2] +
                                                            r[1].dot(r[2]) * l[0] + r[2].dot(r[0]) * l[1]);
    }
    return sum / (4 * 3.14159265358979323846);
  }

 private:
  Vec3 corner(std::uint32_t v) const {
    return Vec3(double(positions[v][0]), double(positions[v][1]), double(positions[v][2]));
  }
  // Triangles share no vertices: their corners are the same floats.
  void divide(const Vec3& a, const Vec3& b, const Vec3& c, int levels, const Vec3& center, double radius) {
    if (levels > 0) {
      const Vec3 ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
      divide(a, ab, ca, levels - 1, center, radius);
      divide(ab, b, bc, levels - 1, center, radius);
      divide(ca, bc, c, levels - 1, center, radius);
      divide(ab, bc, ca, levels - 1, center, radius);
      return;
    }
    const auto n = static_cast<std::uint32_t>(positions.size());
    for (const Vec3& p : {a, b, c}) {
      const Vec3 x = center + radius * p;
      positions.push_back({float(x.x()), float(x.y()), float(x.z())});
    }
    triangles.push_back({n, n + 1, n + 2});
  }
};

/// Compares at every grid point that is farther from the mesh than vertices are moved.
void compare(const Mesh& mesh, double cell, int reach) {
  const demo::Winding winding(mesh.positions, mesh.triangles, cell);
  int compared = 0, inside = 0;
  for (int k = -reach; k <= reach; ++k)
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i) {
        if (mesh.distance(cell * Vec3(i, j, k)) < 2 * demo::Winding::resolution * cell) continue;
        const double exact = mesh.winding(cell * Vec3(i, j, k));
        ++compared;
        inside += exact > 0.5;
        ASSERT_EQ(winding.at(i, j, k), std::lround(exact)) << i << " " << j << " " << k;
      }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(inside, 100);
}

TEST(Winding, counts_a_cavity_as_outside_and_a_drop_in_it_as_inside) {
  Mesh mesh;
  mesh.add_ball(Vec3(0.013, -0.007, 0.003), 1, 3, false);
  mesh.add_ball(Vec3(0.1, 0, 0), 0.6, 2, true);
  mesh.add_ball(Vec3(0.1, 0.05, 0), 0.3, 2, false);
  compare(mesh, 0.1, 11);
}

TEST(Winding, rays_through_edges_and_corners_count_once) {
  // The corners of the octahedron, and its edges in planes of the grid, lie on rays.
  for (const int levels : {0, 1}) {
    Mesh mesh;
    mesh.add_ball(Vec3::Zero(), 1, levels, false);
    compare(mesh, 0.125, 9);
    compare(mesh, 0.0625, 17);
  }
}

TEST(Winding, of_overlapping_pieces_adds_up) {
  Mesh mesh;
  mesh.add_ball(Vec3(-0.3, 0, 0), 0.8, 2, false);
  mesh.add_ball(Vec3(0.3, 0.1, 0), 0.8, 2, false);
  compare(mesh, 0.1, 12);
}

}  // namespace
}  // namespace oilskin::test
