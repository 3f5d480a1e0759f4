// The acceptance test of a mesh: closed, manifold, no obstacle inside it or closer than the gap.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/assert.h"
#include "core/disjoint_sets.h"
#include "oilskin/reconstruction.h"
#include "reconstruction/blobs.h"
#include "reconstruction/line_crossings.h"
#include "reconstruction/obstacles.h"
#include "reconstruction/triangle_distance.h"
#include "reconstruction/triangle_pairs.h"
#include "reconstruction/turned_parts.h"

namespace oilskin {

namespace {

using namespace reconstruction;  // NOLINT: the module of this file

/// Of the triangles: there may be vertices that none uses.
Box bounds(const WaterMesh& mesh) {
  Box box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) box.add(vec(mesh.positions[v]));
  return box;
}

void count_pairs(const WaterMesh& mesh, const Obstacles& obstacles, double gap, const Workers& workers,
                 MeshCheck& check) {
  const Box box = bounds(mesh);
  // Along another axis than where the mesh is made.
  LineCrossings crossings(mesh.positions, mesh.triangles, 0);
  crossings.add_all();
  const double extent = (box.max - box.min).maxCoeff();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double reach = gap + 1e-3 * extent, above_gap = std::nextafter(gap, infinity);
  // Integer sums and a minimum do not depend on the order of threads.
  std::mutex mutex;
  for_near_pairs(mesh.positions, mesh.triangles, nullptr, obstacles, reach, workers,
                 [&](std::uint32_t t, Span<const std::uint32_t> candidates) {
                   double least = reach, found = infinity;
                   {
                     const std::lock_guard<std::mutex> lock(mutex);
                     least = std::min(least, check.min_distance);
                   }
                   const Corners own = stored_corners(mesh.positions, mesh.triangles[t]);
                   std::size_t intersecting = 0, too_close = 0;
                   for (std::uint32_t c : candidates) {
                     // A distance beyond the gap and the least one changes no count: it need not be exact.
                     const double enough = std::max(least, above_gap);
                     const double d = certified_distance(own, obstacles.corners(c), enough);
                     intersecting += !(d > 0);
                     too_close += !(d > gap);
                     least = std::min(least, d);
                     // Beyond the gap it is exact where it is less than all before.
                     if (d < reach || d <= gap) found = std::min(found, d);
                   }
                   const std::lock_guard<std::mutex> lock(mutex);
                   check.intersecting_pairs += intersecting;
                   check.too_close_pairs += too_close;
                   check.min_distance = std::min(check.min_distance, found);
                 });
}

/// What is wrong at vertices, and at the edges to higher vertices.
struct Flaws {
  std::size_t open_edges = 0, crowded_edges = 0, misoriented_edges = 0, pinched_vertices = 0;

  void operator+=(const Flaws& o) {
    open_edges += o.open_edges;
    crowded_edges += o.crowded_edges;
    misoriented_edges += o.misoriented_edges;
    pinched_vertices += o.pinched_vertices;
  }
};

/// A triangle at a vertex: the vertices that follow and precede it.
struct Corner {
  std::uint32_t next, previous;
};

/// The corners of all triangles, those of a vertex together.
class VertexCorners {
 public:
  explicit VertexCorners(const WaterMesh& mesh)
      : end_(mesh.positions.size() + 1), corners_(3 * mesh.triangles.size()) {
    OILSKIN_ASSERT(mesh.positions.size() < (1ull << 31));
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) {
        OILSKIN_ASSERT(v < mesh.positions.size());
        ++end_[v + 1];
      }
    for (std::size_t v = 0; v + 1 < end_.size(); ++v) end_[v + 1] += end_[v];
    // Each place counts up from the start of its vertex to the start of the next one.
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) corners_[end_[t[k]]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
  }
  /// Of vertex v, by ascending `next`.
  void copy(std::size_t v, std::vector<Corner>& corners) const {
    corners.assign(corners_.begin() + std::ptrdiff_t(v > 0 ? end_[v - 1] : 0),
                   corners_.begin() + std::ptrdiff_t(end_[v]));
    std::sort(corners.begin(), corners.end(),
              [](const Corner& a, const Corner& b) { return a.next < b.next; });
  }

 private:
  std::vector<std::size_t> end_;
  std::vector<Corner> corners_;
};

/// Of the edges from `vertex` to higher vertices. `edges` is scratch: the other vertex; lowest bit: towards
/// `vertex`.
void add_edges(std::uint32_t vertex, const std::vector<Corner>& corners, std::vector<std::uint32_t>& edges,
               Flaws& flaws) {
  edges.clear();
  for (const Corner& c : corners) {
    if (c.next >= vertex) edges.push_back(c.next << 1);
    if (c.previous > vertex) edges.push_back(c.previous << 1 | 1);
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] >> 1 == edges[i] >> 1) ++end;
    if (end - i == 1) ++flaws.open_edges;
    if (end - i > 2) ++flaws.crowded_edges;
    if (end - i == 2 && edges[i] == edges[i + 1]) ++flaws.misoriented_edges;
    i = end;
  }
}

/// Does following `previous` visit all corners of a vertex, and no other?
bool is_one_closed_fan(const std::vector<Corner>& corners) {
  std::size_t steps = 0;
  std::uint32_t at = corners.front().next;
  do {
    const auto found =
        std::find_if(corners.begin(), corners.end(), [at](const Corner& c) { return c.next == at; });
    if (found == corners.end()) return false;
    at = found->previous;
    ++steps;
  } while (at != corners.front().next && steps <= corners.size());
  return at == corners.front().next && steps == corners.size();
}

/// Are there corners of a vertex that no edge connects with the others? Edges that are open, crowded or
/// misoriented are counted elsewhere.
bool is_pinched(const std::vector<Corner>& corners) {
  if (corners.empty() || is_one_closed_fan(corners)) return false;
  std::vector<std::uint32_t> around;
  for (const Corner& c : corners) around.insert(around.end(), {c.next, c.previous});
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  const auto number = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(around.begin(), around.end(), v) - around.begin());
  };
  DisjointSets fans(around.size());
  for (const Corner& c : corners) fans.unite(number(c.next), number(c.previous));
  for (std::uint32_t i = 0; i < around.size(); ++i)
    if (fans.find(i) != 0) return true;
  return false;
}

void count_flaws(const WaterMesh& mesh, const Workers& workers, MeshCheck& check) {
  const VertexCorners corners(mesh);
  const Flaws all =
      workers.ordered_sum(mesh.positions.size(), 1 << 12, Flaws{}, [&](std::size_t from, std::size_t to) {
        Flaws flaws;
        std::vector<Corner> own;
        std::vector<std::uint32_t> edges;
        for (std::size_t v = from; v < to; ++v) {
          corners.copy(v, own);
          add_edges(static_cast<std::uint32_t>(v), own, edges, flaws);
          flaws.pinched_vertices += is_pinched(own);
        }
        return flaws;
      });
  check.open_edges = all.open_edges;
  check.crowded_edges = all.crowded_edges;
  check.misoriented_edges = all.misoriented_edges;
  check.pinched_vertices = all.pinched_vertices;
}

void count_components(const WaterMesh& mesh, const Workers& workers, MeshCheck& check) {
  DisjointSets sets(mesh.positions.size());
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
    for (std::uint32_t v : t) used[v] = true;
  }
  std::vector<std::uint32_t> part(used.size());
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    part[v] = sets.find(v);  // its smallest vertex
    check.components += used[v] && part[v] == v;
  }
  const std::vector<double> volume = part_volumes(mesh.positions, mesh.triangles, part, workers);
  check.turned_components =
      TurnedParts(mesh.positions, mesh.triangles, part, volume, workers).numbers().size();
}

}  // namespace

MeshCheck check_mesh(const WaterMesh& mesh, Span<const ObstacleMesh> obstacle_meshes, double gap,
                     int threads) {
  OILSKIN_ASSERT(gap >= 0);
  MeshCheck check;
  const Workers workers(threads);
  count_flaws(mesh, workers, check);
  count_components(mesh, workers, check);
  for (const Triangle& t : mesh.triangles)
    check.volume += six_volumes(mesh.positions, t, mesh.positions[mesh.triangles[0][0]]) / 6;

  Obstacles obstacles(obstacle_meshes);
  if (obstacles.empty() || mesh.triangles.empty()) return check;
  obstacles.prepare_queries(workers);
  count_pairs(mesh, obstacles, gap, workers, check);
  const Box box = bounds(mesh);
  // Along another axis than where the mesh is made.
  LineCrossings crossings(mesh.positions, mesh.triangles, 0);
  crossings.add_all();
  for (const auto& piece : obstacles.pieces()) {
    const bool leaves_box = std::any_of(piece.begin(), piece.end(),
                                        [&](std::uint32_t v) { return !box.contains(obstacles.vertex(v)); });
    if (leaves_box) continue;  // it has a point outside the mesh
    check.submerged_components += crossings.beyond(obstacles.vertex(piece[0])) != 0;
  }
  return check;
}

}  // namespace oilskin
