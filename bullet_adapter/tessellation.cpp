#include "tessellation.h"

#include <LinearMath/btConvexHullComputer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace oilskin::bullet {

namespace {

/// Parts of an edge of the icosahedron.
constexpr std::uint32_t fewest_parts = 2, most_parts = 8;

PointMesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  PointMesh mesh;
  for (double a : {-1.0, 1.0})
    for (double b : {-g, g})
      for (const Vec3& p : {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)})
        mesh.points.push_back(p.normalized());
  // Faces are the triples of neighbours; edges are the shortest distances.
  const double edge = 2 / std::sqrt(1 + g * g), max_edge = 1.1 * edge;
  auto adjacent = [&](std::uint32_t i, std::uint32_t j) {
    return (mesh.points[i] - mesh.points[j]).norm() < max_edge;
  };
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = i + 1; j < 12; ++j)
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!adjacent(i, j) || !adjacent(j, k) || !adjacent(i, k)) continue;
        const Vec3 n = (mesh.points[j] - mesh.points[i]).cross(mesh.points[k] - mesh.points[i]);
        if (n.dot(mesh.points[i]) > 0)
          mesh.triangles.push_back({i, j, k});
        else
          mesh.triangles.push_back({i, k, j});
      }
  return mesh;
}

/// The triangles of an icosahedron, each divided into `parts`² whose points are moved outwards to the sphere.
PointMesh divided_icosahedron(std::uint32_t parts) {
  const PointMesh coarse = icosahedron();
  PointMesh fine;
  // By how many parts of which corners: the same for all triangles that share a point.
  std::map<std::map<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  auto number_of = [&](const Triangle& corner, std::uint32_t u, std::uint32_t v) {
    std::map<std::uint32_t, std::uint32_t> weights;
    const std::uint32_t weight[3] = {parts - u - v, u, v};
    for (std::size_t k = 0; k < 3; ++k)
      if (weight[k] > 0) weights[corner[k]] = weight[k];
    const auto [it, is_new] = numbers.try_emplace(weights, static_cast<std::uint32_t>(fine.points.size()));
    if (is_new) {
      Vec3 sum = Vec3::Zero();
      for (const auto& [point, count] : weights) sum += count * coarse.points[point];
      fine.points.push_back(sum.normalized());
    }
    return it->second;
  };
  for (const Triangle& t : coarse.triangles)
    for (std::uint32_t u = 0; u < parts; ++u)
      for (std::uint32_t v = 0; u + v < parts; ++v) {
        const std::uint32_t a = number_of(t, u, v), b = number_of(t, u + 1, v), c = number_of(t, u, v + 1);
        fine.triangles.push_back({a, b, c});
        if (u + v + 1 < parts) fine.triangles.push_back({b, number_of(t, u + 1, v + 1), c});
      }
  return fine;
}

/// The smallest distance of a triangle's plane from the centre.
double inradius(const PointMesh& sphere) {
  double smallest = 1;
  for (const Triangle& t : sphere.triangles) {
    const Vec3& a = sphere.points[t[0]];
    const Vec3 n = (sphere.points[t[1]] - a).cross(sphere.points[t[2]] - a).normalized();
    smallest = std::min(smallest, n.dot(a));
  }
  return smallest;
}

/// Of a closed mesh [m³]; rounding is the less, the nearer `reference` is.
double volume(const PointMesh& mesh, const Vec3& reference) {
  double six_volumes = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]] - reference, b = mesh.points[t[1]] - reference,
               c = mesh.points[t[2]] - reference;
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6;
}

/// Of radius 1.
struct UnitSphere {
  PointMesh mesh;
  double inradius;
  double scale_to_ball;  ///< what its points must be multiplied by for the volume of the unit ball

  explicit UnitSphere(std::uint32_t parts)
      : mesh(divided_icosahedron(parts)),
        inradius(bullet::inradius(mesh)),
        scale_to_ball(std::cbrt(4 * std::acos(-1.0) / 3 / volume(mesh, Vec3::Zero()))) {}
};

/// The coarsest division that `is_near` accepts, else the finest. All are made once: shapes are read in
/// queries, and in each step in which they change.
template <class F>
const UnitSphere& coarsest_sphere(const F& is_near) {
  static const std::vector<UnitSphere> all = [] {
    std::vector<UnitSphere> made;
    for (std::uint32_t parts = fewest_parts; parts <= most_parts; ++parts) made.emplace_back(parts);
    return made;
  }();
  const auto found = std::find_if(all.begin(), all.end(), is_near);
  return found != all.end() ? *found : all.back();
}

/// Removes the points that no triangle uses.
void compact(PointMesh& mesh) {
  std::map<std::uint32_t, std::uint32_t> kept;
  std::vector<Vec3> points;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& node : t) {
      const auto [it, is_new] = kept.try_emplace(node, static_cast<std::uint32_t>(points.size()));
      if (is_new) points.push_back(mesh.points[node]);
      node = it->second;
    }
  mesh.points = std::move(points);
}

bool is_flat(const PointMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.points) box.add(p);
  const double size = (box.max - box.min).norm();
  return 6 * std::abs(volume(mesh, mesh.points[0])) <= 1e-9 * size * size * size;
}

/// Keeps the part of a convex polygon with sign · x[axis] ≤ sign · bound.
std::vector<Vec3> clip(const std::vector<Vec3>& polygon, int axis, double sign, double bound) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      Vec3 cut = a + da / (da - db) * (b - a);
      cut[axis] = bound;
      kept.push_back(cut);
    }
  }
  return kept;
}

}  // namespace

const std::vector<Vec3>& even_directions(double radius, double tolerance) {
  return coarsest_sphere(
             [&](const UnitSphere& sphere) { return radius * (1 - sphere.inradius) <= tolerance; })
      .mesh.points;
}

PointMesh sphere_of_equal_volume(double radius, double tolerance) {
  const UnitSphere& sphere =
      coarsest_sphere([&](const UnitSphere& one) { return radius * (one.scale_to_ball - 1) <= tolerance; });
  PointMesh mesh = sphere.mesh;
  const double scale = radius * sphere.scale_to_ball;
  for (Vec3& p : mesh.points) p *= scale;
  return mesh;
}

PointMesh convex_hull(const btAlignedObjectArray<btVector3>& points) {
  PointMesh mesh;
  if (points.size() < 4) return mesh;
  btConvexHullComputer hull;
  hull.compute(&points[0].m_floats[0], static_cast<int>(sizeof(btVector3)), points.size(), 0, 0);
  for (int i = 0; i < points.size(); ++i) {
    const btVector3& p = points[i];
    mesh.points.emplace_back(p.x(), p.y(), p.z());
  }
  // The hull computer rounds its own vertices; the original ones are exact.
  auto original = [&](int v) { return static_cast<std::uint32_t>(hull.original_vertex_index[v]); };
  for (int f = 0; f < hull.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    const std::uint32_t corner = original(first->getSourceVertex());
    for (auto* e = first->getNextEdgeOfFace(); e->getTargetVertex() != first->getSourceVertex();
         e = e->getNextEdgeOfFace())
      mesh.triangles.push_back({corner, original(e->getSourceVertex()), original(e->getTargetVertex())});
  }
  compact(mesh);
  return mesh.triangles.empty() || is_flat(mesh) ? PointMesh() : mesh;
}

PointMesh clipped_plane(const Vec3& normal, double constant, const Box& box) {
  const Vec3 center = 0.5 * (box.min + box.max);
  const double reach = (box.max - box.min).norm();
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  const Vec3 foot = center - (normal.dot(center) - constant) * normal;
  std::vector<Vec3> polygon = {foot - reach * u - reach * v, foot + reach * u - reach * v,
                               foot + reach * u + reach * v, foot - reach * u + reach * v};
  for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
    polygon = clip(polygon, axis, 1, box.max[axis]);
    polygon = clip(polygon, axis, -1, box.min[axis]);
  }
  PointMesh mesh;
  for (const Vec3& p : polygon)
    if (mesh.points.empty() || (p != mesh.points.back() && p != mesh.points.front()))
      mesh.points.push_back(p);
  for (std::uint32_t i = 1; i + 1 < mesh.points.size(); ++i) mesh.triangles.push_back({0, i, i + 1});
  if (mesh.triangles.empty()) mesh.points.clear();
  return mesh;
}

}  // namespace oilskin::bullet
