#include "study/cases/shapes.h"

#include <map>

#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

/// Adds vertices only where there is none yet, so that faces share them.
class Welder {
 public:
  explicit Welder(Mesh& mesh) : mesh_(mesh) {}

  std::uint32_t node(const std::array<int, 3>& key, const Vec3& at) {
    const auto [entry, fresh] = known_.emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (fresh) mesh_.vertices.push_back(at);
    return entry->second;
  }

 private:
  Mesh& mesh_;
  std::map<std::array<int, 3>, std::uint32_t> known_;
};

/// Point (i, j) of the cube's face towards `side` of `axis`, in n-ths of half an edge, −n … n.
std::array<int, 3> cube_point(int axis, int side, int i, int j, int n) {
  std::array<int, 3> p{};
  p[axis] = side * n;
  // The order of the other two axes turns with the side, so that all faces run the same way round outside.
  p[(axis + (side > 0 ? 1 : 2)) % 3] = 2 * i - n;
  p[(axis + (side > 0 ? 2 : 1)) % 3] = 2 * j - n;
  return p;
}

}  // namespace

std::vector<Emitter> water_around(const Box& outer, const Box& hole) {
  std::vector<Emitter> boxes;
  Box rest = outer;
  for (int axis = 0; axis < 3; ++axis) {
    Box below = rest, above = rest;
    below.max[axis] = rest.min[axis] = hole.min[axis];
    above.min[axis] = rest.max[axis] = hole.max[axis];
    boxes.emplace_back(water_box(below.min, below.max));
    boxes.emplace_back(water_box(above.min, above.max));
  }
  return boxes;
}

Mesh swept_sheet(const std::vector<Point2>& line, double z0, double z1, int cells) {
  Mesh mesh;
  for (int k = 0; k <= cells; ++k)
    for (const Point2& p : line) mesh.vertices.emplace_back(p[0], p[1], z0 + (z1 - z0) * k / cells);
  const auto row = static_cast<std::uint32_t>(line.size());
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(cells); ++k)
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = k * row + i, b = a + 1, c = b + row, d = a + row;
      // Diagonals alternate, so that the sheet shears equally to both sides.
      if ((i + k) % 2 == 0) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  return mesh;
}

Mesh prism_mesh(const std::vector<Point2>& polygon, double z0, double z1) {
  std::vector<Point2> loop = polygon;
  Mesh mesh;
  for (const double z : {z0, z1})
    for (const Point2& p : loop) mesh.vertices.emplace_back(p[0], p[1], z);
  const auto n = static_cast<std::uint32_t>(loop.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
    if (i == 0 || next == 0) continue;
    // A fan covers parts of a hollow polygon's surroundings twice, in opposite directions: winding numbers
    // are right.
    mesh.triangles.push_back({0, next, i});
    mesh.triangles.push_back({n, n + i, n + next});
  }
  return mesh;
}

PlacedMeshEmitter water_in(Mesh mesh) {
  PlacedMeshEmitter emitter;
  emitter.mesh.mesh = std::move(mesh);
  return emitter;
}

Mesh ball_mesh(const Vec3& center, double radius, int n) {
  Mesh mesh;
  Welder welder(mesh);
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, side = face % 2 == 0 ? 1 : -1;
    const auto node = [&](int i, int j) {
      const std::array<int, 3> p = cube_point(axis, side, i, j, n);
      return welder.node(p, center + radius * Vec3(p[0], p[1], p[2]).normalized());
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        mesh.triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
        mesh.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
      }
  }
  return mesh;
}

Cloth mesh_cloth(Mesh mesh, double areal_density) {
  Cloth cloth;
  cloth.mesh.emplace();
  cloth.mesh->mesh = std::move(mesh);
  cloth.areal_density = areal_density;
  return cloth;
}

void pin(Cloth& cloth, const Box& within) {
  PinBox box;
  box.within = within;
  cloth.pins.kind = PinKind::boxes;
  cloth.pins.boxes.push_back(box);
}

}  // namespace oilskin::demo
