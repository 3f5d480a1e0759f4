#include "effects/wetting/wetting_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/disjoint_sets.h"
#include "core/mesh_topology.h"

namespace oilskin {

namespace {

/// Triangles with a smaller height over their longest edge are degenerate: their cotangents are rounding.
constexpr double least_height = 1e-6;
/// Weights below this part of their terms are zero, as at the diagonals of right-angled grids.
constexpr double zero_weight = 1e-12;

/// A term of T_ij, and the sum of the absolute values of its parts.
struct Weight {
  std::uint32_t first, second;
  double value, magnitude;
};

/// Twice the area; 0 for a degenerate triangle.
double double_area(const std::array<Vec3, 3>& x) {
  const Vec3 a = x[1] - x[0], b = x[2] - x[1], c = x[0] - x[2];
  const double area = a.cross(b).norm();
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
  return area > least_height * longest ? area : 0;
}

/// Unit warp and weft in the plane of a triangle. Without a warp direction in the plane: along an edge.
std::array<Vec3, 2> threads(const std::array<Vec3, 3>& x, const Vec3& warp, bool& has_warp) {
  const Vec3 normal = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
  const Vec3 in_plane = warp - normal.dot(warp) * normal;
  has_warp = in_plane.norm() > 1e-6 * warp.norm();
  const Vec3 along = (has_warp ? in_plane : Vec3(x[1] - x[0])).normalized();
  return {along, normal.cross(along)};
}

/// −A ∇φ_i · K̂ ∇φ_j for the three edges, (W.4).
void add_weights(const std::array<Vec3, 3>& x, const Triangle& nodes, double area2, const Fabric& fabric,
                 std::vector<Weight>& weights) {
  bool has_warp = false;
  const auto [warp, weft] = threads(x, fabric.warp, has_warp);
  const double ratio = has_warp ? fabric.anisotropy : 1;
  const double k_warp = 2 * ratio / (1 + ratio), k_weft = 2 / (1 + ratio);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    // ∇φ_i is the opposite edge, turned by 90° and divided by 2 A.
    const Vec3 a = x[k] - x[j], b = x[i] - x[k];
    const double p = -k_warp * a.dot(weft) * b.dot(weft) / (2 * area2);
    const double q = -k_weft * a.dot(warp) * b.dot(warp) / (2 * area2);
    const double size = a.norm() * b.norm() * std::max(k_warp, k_weft) / (2 * area2);
    weights.push_back({std::min(nodes[i], nodes[j]), std::max(nodes[i], nodes[j]), p + q,
                       std::max(std::abs(p) + std::abs(q), 1e-4 * size)});
  }
}

}  // namespace

WettingMesh::WettingMesh(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric)
    : capacity(rest.size(), 0) {
  add_edges(rest, triangles, fabric);
  link_nodes();
  find_parts();
}

void WettingMesh::add_edges(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric) {
  const MeshTopology topology(triangles, rest.size());
  std::vector<Weight> weights;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Triangle& nodes = triangles[t];
    const std::array<Vec3, 3> x = {rest[nodes[0]], rest[nodes[1]], rest[nodes[2]]};
    const double area2 = topology.is_duplicate(t) ? 0 : double_area(x);
    if (area2 == 0) continue;
    for (const std::uint32_t node : nodes) capacity[node] += fabric.capacity * area2 / 6;
    add_weights(x, nodes, area2, fabric, weights);
  }
  std::stable_sort(weights.begin(), weights.end(), [](const Weight& a, const Weight& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  for (std::size_t i = 0, j = 0; i < weights.size(); i = j) {
    Weight sum = weights[i];
    for (j = i + 1; j < weights.size() && weights[j].first == sum.first && weights[j].second == sum.second;
         ++j) {
      sum.value += weights[j].value;
      sum.magnitude += weights[j].magnitude;
    }
    if (std::abs(sum.value) <= zero_weight * sum.magnitude) continue;
    edges.push_back({sum.first, sum.second, fabric.capacity * fabric.diffusivity * sum.value});
    has_negative = has_negative || sum.value < 0;
  }
}

void WettingMesh::link_nodes() {
  begin.assign(capacity.size() + 1, 0);
  for (const Edge& e : edges)
    for (const std::uint32_t node : {e.first, e.second}) ++begin[node + 1];
  for (std::size_t i = 0; i < capacity.size(); ++i) begin[i + 1] += begin[i];
  link.resize(2 * edges.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    link[next[edges[e].first]++] = {edges[e].second, e};
    link[next[edges[e].second]++] = {edges[e].first, e};
  }
}

void WettingMesh::find_parts() {
  DisjointSets sets(capacity.size());
  for (const Edge& e : edges) sets.unite(e.first, e.second);
  part.resize(capacity.size());
  for (std::uint32_t i = 0; i < capacity.size(); ++i) {
    const std::uint32_t root = sets.find(i);
    part[i] = root == i ? static_cast<std::uint32_t>(part_count++) : part[root];
  }
}

}  // namespace oilskin
