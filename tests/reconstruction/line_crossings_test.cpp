// How many parts of a closed mesh a point lies in, against the winding number by solid angles.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "fluid/kernels.h"
#include "reconstruction/line_crossings.h"
#include "support/random.h"

namespace oilskin::reconstruction {
namespace {

struct Mesh {
  std::vector<std::array<float, 3>> positions;
  std::vector<Triangle> triangles;

  /// A cube of n³ cells, whose vertices lie on the lines of a grid; turned inside out if `sign` is −1.
  void add_cube(const Vec3& corner, double size, int n, int sign = 1) {
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (int i = 0; i <= n; ++i)
          for (int j = 0; j <= n; ++j) {
            Vec3 x = corner;
            x[axis] += side * size;
            x[(axis + 1) % 3] += i * size / n;
            x[(axis + 2) % 3] += j * size / n;
            positions.push_back({float(x.x()), float(x.y()), float(x.z())});
          }
        const bool turned = (side == 0) == (sign > 0);
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
          triangles.push_back({first + a, first + (turned ? c : b), first + (turned ? b : c)});
        };
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            const auto m = std::uint32_t(n + 1), k = std::uint32_t(i) * m + std::uint32_t(j);
            add(k, k + m, k + m + 1);
            add(k, k + m + 1, k + 1);
          }
      }
    join();
  }
  /// Vertices at the same place become one.
  void join() {
    std::map<std::array<float, 3>, std::uint32_t> known;
    std::vector<std::array<float, 3>> kept;
    std::vector<std::uint32_t> number;
    for (const auto& p : positions) {
      const auto [at, is_new] = known.try_emplace(p, std::uint32_t(kept.size()));
      if (is_new) kept.push_back(p);
      number.push_back(at->second);
    }
    for (Triangle& t : triangles)
      for (std::uint32_t& v : t) v = number[v];
    positions = kept;
  }
  /// Moves vertices, in any order of their numbers.
  void disturb(test::Random& random, double by) {
    for (auto& p : positions)
      for (float& x : p) x += float(random.uniform(-by, by));
  }

  double winding_number(const Vec3& x) const {
    double sum = 0;
    for (const Triangle& t : triangles) {
      Vec3 r[3];
      for (int k = 0; k < 3; ++k) {
        const auto& p = positions[t[std::size_t(k)]];
        r[k] = Vec3(double(p[0]), double(p[1]), double(p[2])) - x;
      }
      const double a = r[0].norm(), b = r[1].norm(), c = r[2].norm();
      sum += std::atan2(r[0].dot(r[1].cross(r[2])),
                        a * b * c + r[0].dot(r[1]) * c + r[1].dot(r[2]) * a + r[2].dot(r[0]) * b);
    }
    return sum / (2 * fluid::pi);
  }
};

void expect_same(const Mesh& mesh, const Vec3& x) {
  const double expected = mesh.winding_number(x);
  for (int axis = 0; axis < 3; ++axis) {
    LineCrossings crossings(mesh.positions, mesh.triangles, axis);
    crossings.add_all();
    EXPECT_EQ(crossings.beyond(x), int(std::lround(expected))) << x.transpose() << " along " << axis;
  }
}

TEST(LineCrossings, are_the_winding_number_at_random_points) {
  test::Random random(3);
  Mesh mesh;
  mesh.add_cube(Vec3::Zero(), 1, 6);
  mesh.add_cube(Vec3(0.5, 0.3, 0.2), 1, 5);        // overlaps it
  mesh.add_cube(Vec3(0.6, 0.6, 0.6), 0.2, 3, -1);  // a bubble
  mesh.disturb(random, 0.02);
  for (int k = 0; k < 1000; ++k)
    expect_same(mesh, Vec3(random.uniform(-0.2, 1.7), random.uniform(-0.2, 1.7), random.uniform(-0.2, 1.7)));
}

/// Is x on a face of the cube of edge 1 from (low, low, low)?
bool is_on_cube(const Vec3& x, double low) {
  return x.minCoeff() >= low && x.maxCoeff() <= low + 1 && (x.minCoeff() == low || x.maxCoeff() == low + 1);
}

// Vertices of a mesh lie on lines of the grid, and so do obstacles at round coordinates.
TEST(LineCrossings, pass_through_edges_and_vertices_once) {
  Mesh mesh;
  mesh.add_cube(Vec3::Zero(), 1, 4);
  mesh.add_cube(Vec3(0.5, 0.5, 0.5), 1, 4);
  for (int i = -1; i <= 13; ++i)
    for (int j = -1; j <= 13; ++j)
      for (const double h : {-0.0625, 0.0625, 0.5625, 1.0625, 1.5625})
        for (int axis = 0; axis < 3; ++axis) {
          Vec3 x;
          x[axis] = h;
          x[(axis + 1) % 3] = i * 0.125;
          x[(axis + 2) % 3] = j * 0.125;
          // On faces of the cubes the number is not defined.
          if (!is_on_cube(x, 0) && !is_on_cube(x, 0.5)) expect_same(mesh, x);
        }
}

}  // namespace
}  // namespace oilskin::reconstruction
