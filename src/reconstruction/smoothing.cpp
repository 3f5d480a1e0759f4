#include "reconstruction/smoothing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/assert.h"
#include "reconstruction/repair.h"
#include "reconstruction/triangle_pairs.h"

namespace oilskin::reconstruction {

namespace {

constexpr double lambda = 0.5, mu = -0.53;
constexpr std::size_t chunk = 1 << 12;

using Float3 = std::array<float, 3>;

/// Of each vertex the next one of each of its triangles: in a closed mesh each neighbour once.
struct Neighbours {
  std::vector<std::uint32_t> begin, next;

  explicit Neighbours(const RawMesh& mesh)
      : begin(mesh.positions.size() + 1, 0), next(3 * mesh.triangles.size()) {
    for (const Triangle& t : mesh.triangles)
      for (std::uint32_t v : t) ++begin[v + 1];
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) begin[v + 1] += begin[v];
    std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) next[at[t[k]]++] = t[(k + 1) % 3];
  }
};

/// What triangles have to spare towards an obstacle, a cell at most.
class Spare {
 public:
  Spare(const Obstacles& obstacles, double gap, double cell) : obstacles_(obstacles), cell_(cell) {
    walls_.reserve(obstacles.size());
    for (std::uint32_t t = 0; t < obstacles.size(); ++t) {
      const Corners c = obstacles.corners(t);
      walls_.push_back({TrianglePrism(c), gap + rounding_of(c)});
    }
  }
  /// Accepts the cheap lower bound if it is within `loss` of the best exact distance.
  double of(const Corners& own, Span<const std::uint32_t> candidates) const {
    std::vector<std::pair<double, std::uint32_t>> order;
    order.reserve(candidates.size());
    double minimum = cell_;
    for (std::uint32_t c : candidates) {
      const TrianglePrism::Distance d = walls_[c].prism.distance_from(own);
      const double bound = d.at_least - walls_[c].limit;
      if (d.is_exact) minimum = std::min(minimum, bound);
      if (bound < minimum) order.emplace_back(bound, c);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [bound, c] : order) {
      if (bound >= (1 - loss) * minimum) return std::min(minimum, bound);
      const double limit = walls_[c].limit;
      const double exact =
          certified_distance(own, obstacles_.corners(c), (minimum + limit) * (1 + 1e-9)) - limit;
      minimum = std::min(minimum, std::max(bound, exact));
    }
    return std::max(0.0, minimum);
  }

 private:
  static constexpr double loss = 0.2;
  struct Wall {
    TrianglePrism prism;
    double limit;  ///< the gap, and what rounding may take
  };
  const Obstacles& obstacles_;
  double cell_;
  std::vector<Wall> walls_;
};

/// How far vertices may move (R.22) [m]: as far as the nearest of their triangles has to spare, and a cell at
/// most, so that what is farther away does not matter.
struct Budgets {
  std::vector<float> of_vertex;     ///< none where nothing limits them
  std::vector<std::uint32_t> near;  ///< the triangles that have less than a cell to spare

  Budgets() = default;
  Budgets(const Obstacles& obstacles, double gap, double cell, const RawMesh& mesh, const Workers& workers) {
    const Spare spares(obstacles, gap, cell);
    const auto maximum = static_cast<float>(cell);
    std::vector<float> spare(mesh.triangles.size(), maximum);
    for_near_pairs(mesh.positions, mesh.triangles, nullptr, obstacles, gap + 1.01 * cell, workers,
                   [&](std::uint32_t t, Span<const std::uint32_t> candidates) {
                     const Corners own = stored_corners(mesh.positions, mesh.triangles[t]);
                     spare[t] = static_cast<float>(spares.of(own, candidates));
                   });
    of_vertex.assign(mesh.positions.size(), maximum);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (spare[t] == maximum) continue;
      near.push_back(t);
      for (std::uint32_t v : mesh.triangles[t]) of_vertex[v] = std::min(of_vertex[v], spare[t]);
    }
    for (std::size_t v = 0; v < of_vertex.size(); ++v) {
      float ulp = 0;
      for (float x : mesh.positions[v]) ulp = std::max(ulp, std::abs(x) * 0x1p-22f);
      of_vertex[v] = std::max(0.0f, 0.999f * of_vertex[v] - ulp);
    }
  }
};

// How far a vertex may go without leaving the box; 0 on its sides, which stay flat.
float room_in(const Box& clip, const Float3& p, double margin) {
  double room = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
    room = std::min({room, p[std::size_t(a)] - clip.min[a], clip.max[a] - p[std::size_t(a)]});
  return room > margin ? static_cast<float>(room) : 0.0f;
}

void move(double factor, const Neighbours& neighbours, const std::vector<Float3>& start,
          const std::vector<float>* budget, const std::vector<Float3>& from, std::vector<Float3>& to,
          const Workers& workers) {
  workers.for_each(from.size(), chunk, [&](std::size_t v) {
    Vec3 sum = Vec3::Zero();
    const Vec3 x(from[v][0], from[v][1], from[v][2]);
    const std::uint32_t begin = neighbours.begin[v], end = neighbours.begin[v + 1];
    OILSKIN_ASSERT(begin < end);
    for (std::uint32_t k = begin; k < end; ++k) {
      const Float3& n = from[neighbours.next[k]];
      sum += Vec3(n[0], n[1], n[2]) - x;
    }
    const Vec3 origin(start[v][0], start[v][1], start[v][2]);
    Vec3 displacement = x + factor / (end - begin) * sum - origin;
    if (budget) {
      const double length = displacement.norm(), maximum = (*budget)[v];
      if (length > maximum) displacement *= maximum / length;
    }
    const Vec3 at = origin + displacement;
    to[v] = {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z())};
  });
}

/// Puts back what does not pass, which only rounding could be the cause of; a vertex put back may spoil a
/// neighbour's triangle, so until all pass.
std::size_t put_back(const Obstacles& obstacles, double gap, const std::vector<std::uint32_t>& near,
                     const std::vector<Float3>& start, RawMesh& mesh, const Workers& workers) {
  std::vector<std::uint8_t> held(mesh.positions.size(), 0);
  for (;;) {
    std::vector<std::uint8_t> failed(mesh.triangles.size(), 0);
    for_near_pairs(mesh.positions, mesh.triangles, &near, obstacles, 1.01 * gap + 1e-30, workers,
                   [&](std::uint32_t t, Span<const std::uint32_t> candidates) {
                     const Corners own = stored_corners(mesh.positions, mesh.triangles[t]);
                     for (std::uint32_t c : candidates) {
                       const Corners other = obstacles.corners(c);
                       if (!certified_apart(own, other, gap + rounding_of(other))) failed[t] = 1;
                     }
                   });
    bool changed = false;
    for (std::size_t t = 0; t < failed.size(); ++t) {
      if (!failed[t]) continue;
      for (std::uint32_t v : mesh.triangles[t]) {
        changed |= !held[v];
        held[v] = 1;
        mesh.positions[v] = start[v];
      }
    }
    if (!changed) break;
  }
  return static_cast<std::size_t>(std::count(held.begin(), held.end(), 1));
}

}  // namespace

SmoothingReport smooth(int iterations, const Obstacles* obstacles, double gap, double cell,
                       const std::optional<Box>& clip, RawMesh& mesh, const Workers& workers) {
  SmoothingReport report;
  if (iterations == 0 || mesh.positions.empty()) return report;
  const Neighbours neighbours(mesh);
  const std::vector<Float3> start = mesh.positions;
  Budgets budgets = obstacles ? Budgets(*obstacles, gap, cell, mesh, workers) : Budgets();
  std::vector<float>& budget = budgets.of_vertex;
  if (clip) {
    if (budget.empty()) budget.assign(start.size(), static_cast<float>(cell));
    for (std::size_t v = 0; v < start.size(); ++v)
      budget[v] = std::min(budget[v], room_in(*clip, start[v], 0.05 * cell));
  }
  const std::vector<float>* limit = budget.empty() ? nullptr : &budget;
  std::vector<Float3> other(start.size());
  for (int i = 0; i < iterations; ++i) {
    move(lambda, neighbours, start, limit, mesh.positions, other, workers);
    move(mu, neighbours, start, limit, other, mesh.positions, workers);
  }
  if (obstacles) report.held = put_back(*obstacles, gap, budgets.near, start, mesh, workers);
  return report;
}

}  // namespace oilskin::reconstruction
