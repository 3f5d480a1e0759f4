// The acceptance test of a mesh: closed, manifold, no obstacle inside it or closer than the gap.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/assert.h"
#include "core/disjoint_sets.h"
#include "oilskin/reconstruction.h"
#include "reconstruction/blobs.h"
#include "reconstruction/obstacle_field.h"
#include "reconstruction/triangle_pairs.h"

namespace oilskin {

namespace {

using namespace reconstruction;  // NOLINT: the module of this file

struct PairCounts {
  std::size_t intersecting = 0, too_close = 0;
  double min_distance = std::numeric_limits<double>::infinity();
};

void count_pairs(const WaterMesh& mesh, const Obstacles& obstacles, double gap, const Workers& workers,
                 MeshCheck& check) {
  Box box;
  for (const auto& p : mesh.positions) box.add(Vec3(p[0], p[1], p[2]));
  const double extent = mesh.positions.empty() ? 0 : (box.max - box.min).maxCoeff();
  // Integer sums and a minimum do not depend on the order of threads.
  std::mutex mutex;
  for_near_pairs(mesh.positions, mesh.triangles, nullptr, obstacles, gap + 1e-3 * extent, workers,
                 [&](std::uint32_t t, Span<const std::uint32_t> candidates) {
                   const Corners own = stored_corners(mesh.positions, mesh.triangles[t]);
                   PairCounts counts;
                   for (std::uint32_t c : candidates) {
                     const double d = certified_distance(own, obstacles.corners(c));
                     counts.intersecting += !(d > 0);
                     counts.too_close += !(d > gap);
                     counts.min_distance = std::min(counts.min_distance, d);
                   }
                   const std::lock_guard<std::mutex> lock(mutex);
                   check.intersecting_pairs += counts.intersecting;
                   check.too_close_pairs += counts.too_close;
                   check.min_distance = std::min(check.min_distance, counts.min_distance);
                 });
}

void count_edges(const WaterMesh& mesh, MeshCheck& check) {
  std::vector<std::uint64_t> edges;  // lower vertex, higher vertex; lowest bit: from the higher to the lower
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = t[k], b = t[(k + 1) % 3];
      OILSKIN_ASSERT(a < mesh.positions.size() && a < (1ull << 31));
      edges.push_back(std::min(a, b) << 33 | std::max(a, b) << 1 | (a > b));
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] >> 1 == edges[i] >> 1) ++end;
    if (end - i == 1) ++check.open_edges;
    if (end - i > 2) ++check.crowded_edges;
    if (end - i == 2 && edges[i] == edges[i + 1]) ++check.misoriented_edges;
    i = end;
  }
}

/// The triangles of a vertex, as (next, previous) vertices: following `previous` must visit all of them.
void count_pinched(const WaterMesh& mesh, MeshCheck& check) {
  struct Corner {
    std::uint32_t vertex, next, previous;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) corners.push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.next < b.next;
  });
  for (std::size_t i = 0; i < corners.size();) {
    std::size_t end = i;
    while (end < corners.size() && corners[end].vertex == corners[i].vertex) ++end;
    std::size_t steps = 0;
    std::uint32_t at = corners[i].next;
    do {
      const auto found =
          std::find_if(corners.begin() + std::ptrdiff_t(i), corners.begin() + std::ptrdiff_t(end),
                       [at](const Corner& c) { return c.next == at; });
      if (found == corners.begin() + std::ptrdiff_t(end)) break;  // an open edge, counted elsewhere
      at = found->previous;
      ++steps;
    } while (at != corners[i].next && steps <= end - i);
    check.pinched_vertices += at == corners[i].next && steps != end - i;
    i = end;
  }
}

void count_components(const WaterMesh& mesh, MeshCheck& check) {
  DisjointSets sets(mesh.positions.size());
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
    for (std::uint32_t v : t) used[v] = true;
  }
  for (std::uint32_t v = 0; v < used.size(); ++v) check.components += used[v] && sets.find(v) == v;
}

}  // namespace

MeshCheck check_mesh(const WaterMesh& mesh, Span<const ObstacleMesh> obstacle_meshes, double gap,
                     int threads) {
  OILSKIN_ASSERT(gap >= 0);
  MeshCheck check;
  const Workers workers(threads);
  count_edges(mesh, check);
  count_pinched(mesh, check);
  count_components(mesh, check);
  RawMesh raw;
  raw.positions = mesh.positions;
  raw.triangles = mesh.triangles;
  for (const Triangle& t : mesh.triangles)
    check.volume += six_volumes(raw.positions, t, mesh.positions[0]) / 6;

  Obstacles obstacles(obstacle_meshes);
  if (obstacles.empty() || mesh.triangles.empty()) return check;
  obstacles.prepare_queries(workers);
  count_pairs(mesh, obstacles, gap, workers, check);
  Box box;
  for (const auto& p : mesh.positions) box.add(Vec3(p[0], p[1], p[2]));
  for (const auto& piece : obstacles.pieces()) {
    const bool leaves_box = std::any_of(piece.begin(), piece.end(),
                                        [&](std::uint32_t v) { return !box.contains(obstacles.vertex(v)); });
    if (leaves_box) continue;  // it has a point outside the mesh
    check.submerged_components +=
        std::abs(winding_number(mesh.positions, mesh.triangles, obstacles.vertex(piece[0]), workers)) > 0.5;
  }
  return check;
}

}  // namespace oilskin
