#include "reconstruction/smoothing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/assert.h"
#include "reconstruction/at_vertices.h"
#include "reconstruction/repair.h"
#include "reconstruction/triangle_pairs.h"

namespace oilskin::reconstruction {

namespace {

/// The gain of a pair of steps is above 1 below the pass band [Taubin1995, 3]: with the usual 0.1, and
/// without the limit of a cell, a block of 6³ particles grows to 9 times its volume in 1000 pairs, with this
/// one to 1.6 times.
constexpr double pass_band = 0.05, lambda = 0.5, mu = 1 / (pass_band - 1 / lambda);
constexpr std::size_t chunk = 1 << 12;

using Float3 = std::array<float, 3>;

/// For each vertex, the next vertex in each of its triangles: in a closed mesh, each neighbour once.
using Neighbours = AtVertices<std::uint32_t>;

/// Distances of triangles to obstacles beyond the limit (R.18), at most a cell.
class SpareDistance {
 public:
  SpareDistance(const Obstacles& obstacles, double gap, double cell) : obstacles_(obstacles), cell_(cell) {
    walls_.reserve(obstacles.size());
    for (std::uint32_t t = 0; t < obstacles.size(); ++t) {
      const Corners c = obstacles.corners(t);
      walls_.push_back({TrianglePrism(c), gap + obstacles.rounding(t)});
    }
  }
  /// Accepts the inexpensive lower bound if it is within `loss` of the best exact distance.
  double of(const Corners& own, Span<const std::uint32_t> candidates) const {
    std::vector<std::pair<double, std::uint32_t>> order;
    order.reserve(candidates.size());
    double spare = cell_;
    for (std::uint32_t c : candidates) {
      const TrianglePrism::Distance d = walls_[c].prism.distance_from(own);
      const double bound = d.lower_bound - walls_[c].limit;
      if (d.is_exact) spare = std::min(spare, bound);
      if (bound < spare) order.emplace_back(bound, c);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [bound, c] : order) {
      if (bound >= (1 - loss) * spare) return std::min(spare, bound);
      const double limit = walls_[c].limit;
      const double exact =
          certified_distance(own, obstacles_.corners(c), (spare + limit) * (1 + 1e-9)) - limit;
      spare = std::min(spare, std::max(bound, exact));
    }
    return std::max(0.0, spare);
  }

 private:
  static constexpr double loss = 0.2;
  struct Wall {
    TrianglePrism prism;
    double limit;  ///< (R.18) [m]
  };
  const Obstacles& obstacles_;
  double cell_;
  std::vector<Wall> walls_;
};

/// Largest displacements of vertices (R.22) [m]: the smallest spare distance of their triangles, at most a
/// cell, so that only obstacles within a cell of the limit matter.
struct Budgets {
  std::vector<float> of_vertex;
  std::vector<std::uint32_t> near;  ///< triangles with less than a cell to spare

  /// `obstacles` may be null. A cell is the limit also where none is near: the mesh must not depend on what
  /// is far away.
  Budgets(const Obstacles* obstacles, double gap, double cell, const RawMesh& mesh, const Workers& workers)
      : of_vertex(mesh.positions.size(), static_cast<float>(cell)) {
    if (obstacles) keep_off(*obstacles, gap, cell, mesh, workers);
    for (std::size_t v = 0; v < of_vertex.size(); ++v) {
      float ulp = 0;
      for (float x : mesh.positions[v]) ulp = std::max(ulp, std::abs(x) * 0x1p-22f);
      of_vertex[v] = std::max(0.0f, 0.999f * of_vertex[v] - ulp);
    }
  }

 private:
  void keep_off(const Obstacles& obstacles, double gap, double cell, const RawMesh& mesh,
                const Workers& workers) {
    const SpareDistance spare_distance(obstacles, gap, cell);
    const auto max_spare = static_cast<float>(cell);
    std::vector<float> spare(mesh.triangles.size(), max_spare);
    for_near_pairs(mesh.positions, mesh.triangles, nullptr, obstacles, gap + 1.01 * cell, workers,
                   [&](std::uint32_t t, Span<const std::uint32_t> candidates) {
                     const Corners own = stored_corners(mesh.positions, mesh.triangles[t]);
                     spare[t] = static_cast<float>(spare_distance.of(own, candidates));
                   });
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (spare[t] == max_spare) continue;
      near.push_back(t);
      for (std::uint32_t v : mesh.triangles[t]) of_vertex[v] = std::min(of_vertex[v], spare[t]);
    }
  }
};

// Distance of a vertex to the sides of the box; 0 within `margin`, so that the sides stay flat.
float distance_to_sides(const Box& clip, const Float3& p, double margin) {
  double distance = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
    distance = std::min({distance, p[std::size_t(a)] - clip.min[a], clip.max[a] - p[std::size_t(a)]});
  return distance > margin ? static_cast<float>(distance) : 0.0f;
}

void move(double factor, const Neighbours& neighbours, const std::vector<Float3>& start,
          const std::vector<float>& budget, const std::vector<Float3>& from, std::vector<Float3>& to,
          const Workers& workers) {
  workers.for_each(from.size(), chunk, [&](std::size_t v) {
    Vec3 sum = Vec3::Zero();
    const Vec3 x(from[v][0], from[v][1], from[v][2]);
    const std::uint32_t begin = neighbours.begin[v], end = neighbours.begin[v + 1];
    OILSKIN_ASSERT(begin < end);
    for (std::uint32_t k = begin; k < end; ++k) {
      const Float3& n = from[neighbours.items[k]];
      sum += Vec3(n[0], n[1], n[2]) - x;
    }
    const Vec3 origin(start[v][0], start[v][1], start[v][2]);
    Vec3 displacement = x + factor / (end - begin) * sum - origin;
    const double length = displacement.norm(), max_length = budget[v];
    if (length > max_length) displacement *= max_length / length;
    const Vec3 at = origin + displacement;
    to[v] = {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z())};
  });
}

/// Calls f for the numbers given, or for all below n.
template <class F>
void for_numbers(const std::vector<std::uint32_t>* only, std::size_t n, const F& f) {
  if (only)
    for (const std::uint32_t k : *only) f(k);
  else
    for (std::uint32_t k = 0; k < n; ++k) f(k);
}

/// What put_back() knows of a vertex.
struct PutBack {
  std::uint8_t pushes = 0;  ///< how often it has been moved off an obstacle
  bool is_back = false;     ///< at its start
  bool is_changed = false;  ///< in this round
};

/// A vertex is moved off obstacles so many times before it goes back.
constexpr std::uint8_t max_pushes = 3;

/// The plane of a triangle of an obstacle from which vertices keep off.
class Side {
 public:
  /// `distance`: what they keep [m].
  Side(const Corners& triangle, double distance) : on_(triangle[0]), distance_(distance) {
    normal_ = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    const double length = normal_.norm();
    normal_ = length > 0 ? Vec3(normal_ / length) : Vec3::Zero();
  }
  /// Moves x along the normal if it is too near, but not farther than `start`, where the vertex began. False:
  /// it stays.
  bool push(const Vec3& start, Vec3& x) const {
    const double lacking = std::min(distance_, height(start, start)) - height(start, x);
    if (!(lacking > 0)) return false;
    x += lacking * side_of(start) * normal_;
    return true;
  }

 private:
  double side_of(const Vec3& start) const { return normal_.dot(start - on_) < 0 ? -1 : 1; }
  double height(const Vec3& start, const Vec3& x) const { return side_of(start) * normal_.dot(x - on_); }

  Vec3 on_, normal_;
  double distance_;
};

}  // namespace

/// A vertex that has moved too near to an obstacle is moved off its plane. Where that does not help, it goes
/// back. Either may make a neighbouring triangle fail, so this repeats until all pass.
std::size_t put_back(const Obstacles& obstacles, double gap, const std::optional<Box>& clip,
                     const std::vector<std::uint32_t>* only, const std::vector<Float3>& start, RawMesh& mesh,
                     const Workers& workers) {
  std::vector<PutBack> state(mesh.positions.size());
  std::vector<std::uint32_t> failed(mesh.triangles.size(), none);  // at this triangle of an obstacle
  std::size_t count = 0;
  const auto change = [&](std::uint32_t v, const Float3& to) {
    count += state[v].pushes == 0 && !state[v].is_back;
    state[v].is_changed = true;
    mesh.positions[v] = to;
  };
  // True if a corner has been moved, now or for another triangle of this round.
  const auto push_off = [&](const Triangle& t, const Side& side) {
    bool is_changed = false;
    for (const std::uint32_t v : t) {
      const Vec3 from = vec(start[v]);
      Vec3 x = vec(mesh.positions[v]);
      if (!state[v].is_changed && !state[v].is_back && state[v].pushes < max_pushes && side.push(from, x)) {
        x = clamped_to(clip, x);
        change(v, {float(x.x()), float(x.y()), float(x.z())});
        ++state[v].pushes;
      }
      is_changed |= state[v].is_changed;
    }
    return is_changed;
  };
  std::vector<std::uint32_t> again;
  for (const std::vector<std::uint32_t>* tested = only;; tested = &again) {
    for_near_pairs(mesh.positions, mesh.triangles, tested, obstacles, 1.01 * gap + 1e-30, workers,
                   [&](std::uint32_t t, Span<const std::uint32_t> candidates) {
                     const Corners own = stored_corners(mesh.positions, mesh.triangles[t]);
                     for (std::uint32_t c : candidates) {
                       if (certified_apart(own, obstacles.corners(c), gap + obstacles.rounding(c))) continue;
                       failed[t] = c;
                       return;
                     }
                   });
    for_numbers(tested, mesh.triangles.size(), [&](std::uint32_t t) {
      if (failed[t] == none) return;
      // A little more than the gap, for rounding.
      const Side side(obstacles.corners(failed[t]), 1.01 * gap + 4 * obstacles.rounding(failed[t]));
      failed[t] = none;
      if (push_off(mesh.triangles[t], side)) return;
      for (const std::uint32_t v : mesh.triangles[t]) {
        if (state[v].is_back) continue;
        change(v, start[v]);
        state[v].is_back = true;
      }
    });
    // The others are as they were when they passed, or their corners are nearer to where they passed.
    std::vector<std::uint32_t> next;
    for_numbers(only, mesh.triangles.size(), [&](std::uint32_t t) {
      const Triangle& c = mesh.triangles[t];
      if (state[c[0]].is_changed || state[c[1]].is_changed || state[c[2]].is_changed) next.push_back(t);
    });
    if (next.empty()) return count;
    for (const std::uint32_t t : next)
      for (const std::uint32_t v : mesh.triangles[t]) state[v].is_changed = false;
    again.swap(next);
  }
}

SmoothingReport smooth(int iterations, const Obstacles* obstacles, double gap, double cell,
                       const std::optional<Box>& clip, RawMesh& mesh, const Workers& workers) {
  SmoothingReport report;
  if (iterations == 0 || mesh.positions.empty()) return report;
  const Neighbours neighbours(mesh.triangles, mesh.positions.size(),
                              [&](std::uint32_t n, std::size_t k) { return mesh.triangles[n][(k + 1) % 3]; });
  const std::vector<Float3> start = mesh.positions;
  Budgets budgets(obstacles, gap, cell, mesh, workers);
  std::vector<float>& budget = budgets.of_vertex;
  if (clip)
    for (std::size_t v = 0; v < start.size(); ++v)
      budget[v] = std::min(budget[v], distance_to_sides(*clip, start[v], 0.05 * cell));
  std::vector<Float3> other(start.size());
  for (int i = 0; i < iterations; ++i) {
    move(lambda, neighbours, start, budget, mesh.positions, other, workers);
    move(mu, neighbours, start, budget, other, mesh.positions, workers);
  }
  if (obstacles) report.held = put_back(*obstacles, gap, clip, &budgets.near, start, mesh, workers);
  return report;
}

}  // namespace oilskin::reconstruction
