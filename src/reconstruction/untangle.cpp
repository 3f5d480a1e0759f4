#include "reconstruction/untangle.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/at_vertices.h"
#include "reconstruction/vertex_data.h"

namespace oilskin::reconstruction {

namespace {

using Float3 = std::array<float, 3>;

constexpr std::size_t chunk = 1 << 10;
constexpr int max_rounds = 8;

/// Of the way to the mean of the neighbours, in a round.
constexpr double step_length = 0.5;

/// The triangles of a vertex have a tangential plane if their area vectors add up to this part of their
/// areas.
constexpr double has_plane = 0.3;

/// Of triangles around those that are turned.
constexpr int rings = 2;

/// Triangles for which f holds, ascending.
template <class F>
std::vector<std::uint32_t> triangles_with(const RawMesh& mesh, const Workers& workers, const F& f) {
  std::vector<std::vector<std::uint32_t>> part((mesh.triangles.size() + chunk - 1) / chunk);
  workers.for_chunks(mesh.triangles.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
    for (std::size_t t = from; t < to; ++t)
      if (f(mesh.triangles[t])) part[c].push_back(static_cast<std::uint32_t>(t));
  });
  std::vector<std::uint32_t> found;
  for (const auto& p : part) found.insert(found.end(), p.begin(), p.end());
  return found;
}

/// Whether a triangle faces against the mean normal of its corners.
bool faces_against(const std::array<Vec3, 3>& x, const Vec3& mean_normal) {
  return (x[1] - x[0]).cross(x[2] - x[0]).dot(mean_normal) < 0;
}

/// The triangles with the vertices of some, and `count` rings around them; marks the vertices of all but the
/// last ring in `inner`, those with all of their triangles.
std::vector<std::uint32_t> with_rings(const RawMesh& mesh, const std::vector<std::uint32_t>& triangles,
                                      int count, std::vector<std::uint8_t>& inner, const Workers& workers) {
  inner.assign(mesh.positions.size(), 0);
  std::vector<std::uint32_t> found = triangles;
  for (int ring = 0; ring <= count; ++ring) {
    for (const std::uint32_t t : found)
      for (const std::uint32_t v : mesh.triangles[t]) inner[v] = 1;
    found = triangles_with(mesh, workers,
                           [&](const Triangle& t) { return inner[t[0]] || inner[t[1]] || inner[t[2]]; });
  }
  return found;
}

/// Part of the mesh: the triangles that are turned over, and those around them.
class Patch {
 public:
  Patch(const RawMesh& mesh, const std::vector<std::uint32_t>& turned, const Workers& workers) {
    std::vector<std::uint8_t> inner;
    const std::vector<std::uint32_t> numbers = with_rings(mesh, turned, rings, inner, workers);
    std::vector<std::uint32_t> place(mesh.positions.size(), none);
    for (const std::uint32_t n : numbers) {
      Triangle t = mesh.triangles[n];
      for (std::uint32_t& v : t) {
        if (place[v] == none) {
          place[v] = static_cast<std::uint32_t>(vertices_.size());
          vertices_.push_back(v);
          may_move_.push_back(inner[v]);
          start_.push_back(vec(mesh.positions[v]));
        }
        v = place[v];
      }
      triangles_.push_back(t);
    }
    const auto place_of = [&](std::uint32_t n) {
      return std::lower_bound(numbers.begin(), numbers.end(), n) - numbers.begin();
    };
    for (const std::uint32_t n : turned) turned_.push_back(static_cast<std::uint32_t>(place_of(n)));
    now_ = start_;
    vertex_seen_.assign(vertices_.size(), 0);
    triangle_seen_.assign(triangles_.size(), 0);
    ring_ = AtVertices<RingEdge>(triangles_, vertices_.size(), [&](std::uint32_t n, std::size_t k) {
      return RingEdge{triangles_[n][(k + 1) % 3], triangles_[n][(k + 2) % 3], n};
    });
    normals_.resize(now_.size());
    workers.for_each(now_.size(), chunk, [&](std::size_t v) { normals_[v] = normal(std::uint32_t(v)); });
  }
  /// Vertices on the sides of the box stay.
  void hold_sides(const Box& clip, double margin) {
    const Box inner = clip.inflated(-margin);
    for (std::size_t v = 0; v < now_.size(); ++v)
      if (!inner.contains(now_[v])) may_move_[v] = 0;
  }
  /// Moves the corners of the triangles that are turned over now. Returns whether any moved.
  bool relax(double max_move, const Workers& workers) {
    std::vector<std::uint32_t> moving;
    ++time_;
    for (const std::uint32_t n : turned_)
      for (const std::uint32_t v : triangles_[n])
        if (may_move_[v] && is_new(vertex_seen_[v])) moving.push_back(v);
    std::vector<Vec3> next(moving.size());
    workers.for_each(moving.size(), chunk, [&](std::size_t m) {
      const std::uint32_t v = moving[m];
      Vec3 move = now_[v] + move_to_mean(v) - start_[v];
      if (const double length = move.norm(); length > max_move) move *= max_move / length;
      next[m] = start_[v] + move;
    });
    std::vector<std::uint32_t> changed;
    for (std::size_t m = 0; m < moving.size(); ++m) {
      const std::uint32_t v = moving[m];
      if (now_[v] == next[m]) continue;
      now_[v] = next[m];
      changed.push_back(v);
    }
    find_turned_around(changed, workers);
    return !changed.empty();
  }
  void write_to(const std::optional<Box>& clip, RawMesh& mesh) const {
    for (std::size_t v = 0; v < now_.size(); ++v) {
      if (now_[v] == start_[v]) continue;
      const Vec3 x = clamped_to(clip, now_[v]);
      mesh.positions[vertices_[v]] = {float(x.x()), float(x.y()), float(x.z())};
    }
  }

 private:
  /// Of a vertex: the edge opposite to it in one of its triangles.
  struct RingEdge {
    std::uint32_t from, to, triangle;
  };

  /// Whether this is the first time since time_ was changed.
  bool is_new(std::uint32_t& seen) const {
    const bool result = seen != time_;
    seen = time_;
    return result;
  }
  template <class F>
  void for_ring(std::uint32_t v, const F& f) const {
    for (std::uint32_t k = ring_.begin[v]; k < ring_.begin[v + 1]; ++k) f(ring_.items[k]);
  }
  /// Twice the area vector of a triangle of the vertex.
  Vec3 area(std::uint32_t v, const RingEdge& e) const {
    return (now_[e.from] - now_[v]).cross(now_[e.to] - now_[v]);
  }
  Vec3 normal(std::uint32_t v) const {
    Vec3 sum = Vec3::Zero();
    for_ring(v, [&](const RingEdge& e) { sum += area(v, e); });
    return sum.normalized();
  }
  /// Of all triangles whose corners, or their normals, depend on the vertices.
  void find_turned_around(const std::vector<std::uint32_t>& changed, const Workers& workers) {
    ++time_;
    std::vector<std::uint32_t> around;
    const auto add = [&](std::uint32_t v) {
      if (is_new(vertex_seen_[v])) around.push_back(v);
    };
    for (const std::uint32_t v : changed) {
      add(v);
      for_ring(v, [&](const RingEdge& e) { add(e.from); });
    }
    workers.for_each(around.size(), chunk, [&](std::size_t n) { normals_[around[n]] = normal(around[n]); });
    turned_.clear();
    for (const std::uint32_t v : around)
      for_ring(v, [&](const RingEdge& e) {
        if (is_new(triangle_seen_[e.triangle])) turned_.push_back(e.triangle);
      });
    std::vector<std::uint8_t> is_good(turned_.size());
    workers.for_each(turned_.size(), chunk, [&](std::size_t n) { is_good[n] = !is_turned(turned_[n]); });
    std::size_t count = 0;
    for (std::size_t n = 0; n < turned_.size(); ++n)
      if (!is_good[n]) turned_[count++] = turned_[n];
    turned_.resize(count);
  }
  /// And may be turned back. A vertex at the border of the patch lacks triangles, so its normal is about
  /// right only.
  bool is_turned(std::uint32_t n) const {
    const Triangle& t = triangles_[n];
    return (may_move_[t[0]] || may_move_[t[1]] || may_move_[t[2]]) &&
           faces_against({now_[t[0]], now_[t[1]], now_[t[2]]},
                         normals_[t[0]] + normals_[t[1]] + normals_[t[2]]);
  }
  /// Along the surface, so that the volume stays; at a sharp rim not at all.
  Vec3 move_to_mean(std::uint32_t v) const {
    Vec3 sum = Vec3::Zero(), all = Vec3::Zero();
    double areas = 0;
    for_ring(v, [&](const RingEdge& e) {
      const Vec3 own = area(v, e);
      sum += now_[e.from] - now_[v];
      all += own;
      areas += own.norm();
    });
    if (!(all.norm() > has_plane * areas)) return Vec3::Zero();
    const Vec3 move = step_length / (ring_.begin[v + 1] - ring_.begin[v]) * sum;
    return move - move.dot(all) / all.squaredNorm() * all;
  }

  std::vector<std::uint32_t> vertices_;  ///< in the mesh; all else is numbered within the patch
  std::vector<std::uint8_t> may_move_;   ///< not at the border of the patch, nor on a side of the clip box
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> turned_;
  AtVertices<RingEdge> ring_;
  std::vector<Vec3> start_, now_;  ///< positions [m]
  std::vector<Vec3> normals_;
  std::uint32_t time_ = 0;
  std::vector<std::uint32_t> vertex_seen_, triangle_seen_;
};

}  // namespace

void untangle(double cell, const std::optional<Box>& clip, const SurfaceBlocks& blocks, RawMesh& mesh,
              const Workers& workers) {
  std::vector<Float3> normals;
  vertex_normals(mesh, blocks, workers, normals);
  const std::vector<std::uint32_t> turned = triangles_with(mesh, workers, [&](const Triangle& t) {
    return faces_against({vec(mesh.positions[t[0]]), vec(mesh.positions[t[1]]), vec(mesh.positions[t[2]])},
                         vec(normals[t[0]]) + vec(normals[t[1]]) + vec(normals[t[2]]));
  });
  if (turned.empty()) return;
  Patch patch(mesh, turned, workers);
  if (clip) patch.hold_sides(*clip, 0.05 * cell);
  for (int round = 0; round < max_rounds && patch.relax(cell, workers); ++round) {
  }
  patch.write_to(clip, mesh);
}

}  // namespace oilskin::reconstruction
