/// Water at sheets, for tests and the benchmark: particles on a jittered lattice, moved off the sheet.
#pragma once

#include <cmath>
#include <functional>

#include "core/closest_point.h"
#include "oilskin/reconstruction.h"
#include "proximity/surface_tree.h"
#include "support/random.h"

namespace oilskin::test {

struct WaterScene {
  double spacing = 0.005;
  std::vector<Vec3> particles;
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<float> saturation;  ///< of the vertices, or none

  ReconstructionInput input() const {
    ReconstructionInput in;
    in.positions = particles;
    if (!triangles.empty()) in.obstacles.push_back({vertices, triangles, saturation});
    return in;
  }
  std::vector<ObstacleMesh> obstacles() const { return input().obstacles; }

  /// Gives each vertex the saturation `of(vertex)`.
  void wet(const std::function<double(const Vec3&)>& of) {
    saturation.clear();
    for (const Vec3& v : vertices) saturation.push_back(static_cast<float>(of(v)));
  }
  /// n × n cells over [0, 1]²; `at(u, v)` in metres.
  void add_sheet(int n, const std::function<Vec3(double, double)>& at) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    const auto stride = static_cast<std::uint32_t>(n + 1);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) vertices.push_back(at(double(i) / n, double(j) / n));
    for (std::uint32_t j = 0; j + 1 < stride; ++j)
      for (std::uint32_t i = 0; i + 1 < stride; ++i) {
        const std::uint32_t a = first + i + stride * j, b = a + 1, c = a + stride, d = c + 1;
        triangles.push_back({a, b, d});
        triangles.push_back({a, d, c});
      }
  }
  void add_water(const Box& box, double jitter, std::uint64_t seed,
                 const std::function<bool(const Vec3&)>& keep = {}) {
    Random random(seed);
    const Vec3 n = (box.max - box.min) / spacing;
    for (int k = 0; k < int(n.z() + 0.5); ++k)
      for (int j = 0; j < int(n.y() + 0.5); ++j)
        for (int i = 0; i < int(n.x() + 0.5); ++i) {
          const Vec3 p = box.min + spacing * (Vec3(i + 0.5, j + 0.5, k + 0.5) + random.in_cube(jitter));
          if (!keep || keep(p)) particles.push_back(p);
        }
  }
  /// Away from the triangle that is nearest, to `least` spacings.
  void push_off(double minimum) {
    proximity::SurfaceTree tree;
    tree.update(triangles, vertices, vertices, Workers(1));
    std::vector<std::uint32_t> near;
    for (Vec3& p : particles)
      for (int round = 0; round < 4; ++round) {
        Box box;
        box.add(p);
        near.clear();
        tree.query(box.inflated(minimum * spacing), near);
        ClosestPoint best;
        best.distance = minimum * spacing;
        for (std::uint32_t t : near) {
          const Triangle& i = triangles[t];
          const ClosestPoint c = closest_point(p, vertices[i[0]], vertices[i[1]], vertices[i[2]]);
          if (c.distance < best.distance) best = c;
        }
        if (!(best.distance < minimum * spacing) || best.distance == 0) break;
        p += best.offset / best.distance * (1.0001 * minimum * spacing - best.distance);
      }
  }
};

inline double waves(double x, double y, double amplitude, double length) {
  return amplitude * (std::sin(6.2831853 * x / length) + 0.7 * std::cos(6.2831853 * (y + 0.3 * x) / length));
}

/// A wavy sheet in the middle of water: `both` sides wet, or the upper only.
inline WaterScene wavy_scene(bool both, double size = 0.1, int cells = 24) {
  WaterScene s;
  const double margin = 0.1 * size;
  const auto height = [=](double x, double y) { return waves(x, y, 0.06 * size, 0.5 * size) + 0.25 * size; };
  s.add_sheet(cells, [=](double u, double v) {
    const double x = margin + u * (size - 2 * margin), y = margin + v * (size - 2 * margin);
    return Vec3(x, y, height(x, y));
  });
  const Box all{Vec3::Zero(), Vec3(size, size, 0.5 * size)};
  if (both) {
    s.add_water(all, 0.2, 1);
  } else {
    s.add_water(all, 0.2, 2, [=](const Vec3& p) {
      return p.z() > height(p.x(), p.y()) && p.z() < height(p.x(), p.y()) + 0.015 && p.x() > 0.2 * size &&
             p.x() < 0.8 * size && p.y() > 0.2 * size && p.y() < 0.8 * size;
    });
  }
  s.push_off(0.2);
  return s;
}

/// Water in a V of two planes ([Huber2013] Fig. 8).
inline WaterScene vee_scene(double size = 0.08) {
  WaterScene s;
  const auto height = [=](double x) { return 0.8 * std::abs(x - 0.5 * size); };
  for (int half = 0; half < 2; ++half)
    s.add_sheet(8, [=](double u, double v) {
      const double x = half == 0 ? 0.5 * size * (1 - u) : 0.5 * size * (1 + u);
      return Vec3(x, v * size, height(x));
    });
  s.add_water({Vec3::Zero(), Vec3(size, size, 0.5 * size)}, 0.2, 3, [=](const Vec3& p) {
    return p.z() > height(p.x()) && p.z() < 0.25 * size && p.y() > 0.01 && p.y() < size - 0.01;
  });
  s.push_off(0.2);
  return s;
}

/// A sheet with overhanging folds in the middle of water.
inline WaterScene crumple_scene(double size = 0.1, int cells = 36) {
  WaterScene s;
  s.add_sheet(cells, [=](double u, double v) {
    const double x = 0.12 * size + 0.76 * size * u, y = 0.12 * size + 0.76 * size * v;
    const double phase = 6.2831853 * 2.5 * u;
    return Vec3(
        x + 0.075 * size * std::sin(2 * phase) + 0.02 * size * std::sin(6.2831853 * 3 * v),
        y + 0.03 * size * std::sin(phase + 4 * v),
        0.3 * size + 0.09 * size * std::sin(phase) + 0.05 * size * std::cos(6.2831853 * 2 * v + 3 * u));
  });
  s.add_water({Vec3::Zero(), Vec3(size, size, 0.6 * size)}, 0.2, 4);
  s.push_off(0.2);
  return s;
}

}  // namespace oilskin::test
