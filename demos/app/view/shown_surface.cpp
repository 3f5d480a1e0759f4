#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "view/shown_scene.h"

namespace oilskin::demo {
namespace {

const double sharp = std::cos(40 * 3.14159265358979323846 / 180);  // cosine of the angle of sharp edges

void put(float (&to)[3], const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

/// Twice the area of each triangle along its normal [m²].
std::vector<Vec3> area_normals(const SurfaceMotion& motion) {
  std::vector<Vec3> normals;
  const std::vector<Vec3>& x = motion.x_t1;
  for (const Triangle& t : motion.triangles) normals.push_back((x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]));
  return normals;
}

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(0, 1, 0);
}

/// Edges of one triangle only.
std::vector<std::uint32_t> border_edges(const std::vector<Triangle>& triangles) {
  std::map<std::array<std::uint32_t, 2>, int> count;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++count[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  std::vector<std::uint32_t> edges;
  for (const auto& [edge, times] : count)
    if (times == 1) edges.insert(edges.end(), edge.begin(), edge.end());
  return edges;
}

ShownMesh shown_cloth(const SurfaceMotion& motion, Span<const float> wetness) {
  ShownMesh mesh;
  const std::size_t n = motion.x_t1.size();
  std::vector<Vec3> normal(n, Vec3::Zero());
  const std::vector<Vec3> areas = area_normals(motion);
  for (std::size_t t = 0; t < motion.triangles.size(); ++t)
    for (const std::uint32_t k : motion.triangles[t]) normal[k] += areas[t];
  mesh.vertices.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    put(mesh.vertices[k].position, motion.x_t1[k]);
    put(mesh.vertices[k].normal, unit(normal[k]));
    mesh.vertices[k].value = wetness.empty() ? 0 : std::min(1.0f, wetness[k]);
    if (motion.inverse_mass[k] == 0) mesh.held.push_back(static_cast<std::uint32_t>(k));
  }
  for (const Triangle& t : motion.triangles) mesh.indices.insert(mesh.indices.end(), t.begin(), t.end());
  mesh.border = border_edges(motion.triangles);
  return mesh;
}

/// Every triangle has vertices of its own.
ShownMesh shown_body(const SurfaceMotion& motion) {
  ShownMesh mesh;
  mesh.is_body = true;
  const std::vector<Vec3> areas = area_normals(motion);
  std::vector<std::vector<std::size_t>> around(motion.x_t1.size());
  for (std::size_t t = 0; t < motion.triangles.size(); ++t)
    for (const std::uint32_t k : motion.triangles[t]) around[k].push_back(t);
  for (std::size_t t = 0; t < motion.triangles.size(); ++t) {
    if (areas[t].isZero(0)) continue;  // nothing to see
    const Vec3 own = unit(areas[t]);
    for (const std::uint32_t k : motion.triangles[t]) {
      Vec3 normal = Vec3::Zero();
      for (const std::size_t other : around[k])
        if (own.dot(unit(areas[other])) >= sharp) normal += areas[other];
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      ShownVertex& vertex = mesh.vertices.emplace_back();
      put(vertex.position, motion.x_t1[k]);
      put(vertex.normal, unit(normal));
      vertex.value = 0;
    }
  }
  return mesh;
}

}  // namespace

ShownMesh shown_surface(const SurfaceMotion& motion, bool is_body, Span<const float> wetness) {
  return is_body ? shown_body(motion) : shown_cloth(motion, wetness);
}

}  // namespace oilskin::demo
