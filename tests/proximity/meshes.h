/// Moving meshes for the tests of candidate search, and the search without a tree.
#pragma once

#include <random>

#include "oilskin/types.h"

namespace oilskin::proximity_test {

struct MovingMesh {
  std::vector<Triangle> triangles;
  std::vector<Vec3> x_t0, x_t1;
};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  Vec3 in_cube(double r) {
    const double x = uniform(-r, r), y = uniform(-r, r), z = uniform(-r, r);
    return {x, y, z};
  }
  std::uint32_t index(std::size_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, static_cast<std::uint32_t>(n - 1))(engine_);
  }

 private:
  std::mt19937 engine_;
};

inline void move(MovingMesh& mesh, double distance, Random& random) {
  mesh.x_t1.clear();
  for (const Vec3& x : mesh.x_t0) mesh.x_t1.push_back(x + random.in_cube(distance));
}

/// n × n nodes over one metre, rippled so that boxes have three extents.
inline MovingMesh sheet(std::uint32_t n, double distance, Random& random) {
  MovingMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j)
      mesh.x_t0.emplace_back(i / (n - 1.0), 0.05 * std::sin(9.0 * i / n) + 0.02 * std::cos(7.0 * j / n),
                             j / (n - 1.0));
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = i * n + j;
      mesh.triangles.push_back({a, a + 1, a + n});
      mesh.triangles.push_back({a + 1, a + n + 1, a + n});
    }
  move(mesh, distance, random);
  return mesh;
}

/// Any three of `nodes` nodes: crossing, duplicate and degenerate triangles included.
inline MovingMesh soup(std::size_t nodes, std::size_t count, double distance, Random& random) {
  MovingMesh mesh;
  for (std::size_t i = 0; i < nodes; ++i) mesh.x_t0.push_back(random.in_cube(1));
  for (std::size_t i = 0; i < count; ++i)
    mesh.triangles.push_back({random.index(nodes), random.index(nodes), random.index(nodes)});
  move(mesh, distance, random);
  return mesh;
}

/// Triangles of edge 1e-5 … 10 side by side.
inline MovingMesh huge_and_tiny(std::size_t count, Random& random) {
  MovingMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double edge = std::pow(10.0, random.uniform(-5, 1));
    const Vec3 c = random.in_cube(1);
    for (int k = 0; k < 3; ++k) mesh.x_t0.push_back(c + random.in_cube(edge));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  move(mesh, 0.01, random);
  return mesh;
}

/// All triangles share node 0.
inline MovingMesh fan(std::uint32_t count, double distance, Random& random) {
  MovingMesh mesh;
  mesh.x_t0.push_back(Vec3::Zero());
  for (std::uint32_t i = 0; i <= count; ++i) {
    const double angle = 6.28 * i / count;
    mesh.x_t0.emplace_back(std::cos(angle), 0.1 * std::sin(5 * angle), std::sin(angle));
  }
  for (std::uint32_t i = 0; i < count; ++i) mesh.triangles.push_back({0, i + 1, i + 2});
  move(mesh, distance, random);
  return mesh;
}

inline Box swept_box(const MovingMesh& mesh, std::size_t t) {
  Box box;
  for (std::uint32_t node : mesh.triangles[t]) {
    box.add(mesh.x_t0[node]);
    box.add(mesh.x_t1[node]);
  }
  return box;
}

inline std::vector<std::uint32_t> brute_force(const MovingMesh& mesh, const Box& box) {
  std::vector<std::uint32_t> found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (swept_box(mesh, t).overlaps(box)) found.push_back(static_cast<std::uint32_t>(t));
  return found;
}

/// Boxes of particles near the origin: swept by up to `sweep`, inflated by h, some of them empty.
inline std::vector<Box> particle_boxes(std::size_t n, double spread, double sweep, double h, Random& random) {
  std::vector<Box> boxes(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 37 == 5) continue;
    const Vec3 x = random.in_cube(spread);
    boxes[i].add(x);
    boxes[i].add(x + random.in_cube(sweep));
    boxes[i] = boxes[i].inflated(h);
  }
  return boxes;
}

}  // namespace oilskin::proximity_test
