#include "fluid/triangle_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t group_chunk = 64;

/// Triangles that are looked at together, at most, and by how much their box may be wider than that of one
/// [H]: consecutive triangles of a mesh mostly lie side by side. 2 to 6 take about the same time.
constexpr std::uint32_t block_size = 8;
constexpr double block_growth = 3;

/// Cells side by side that are looked at together, as a power of two: a film has few particles a cell.
constexpr int group_bits = 2;

/// Bounds are widened by this much, more than rounding can make of them.
constexpr double rounding = 1 + 1e-9;

NearbyTriangle triangle_of(const SurfaceMotion& motion, const MeshTopology& topology, std::uint32_t surface,
                           std::uint32_t triangle) {
  const Triangle& node = motion.triangles[triangle];
  const Vec3 &a = motion.x_t0[node[0]], &b = motion.x_t0[node[1]], &c = motion.x_t0[node[2]];
  NearbyTriangle t;
  t.surface = surface;
  t.triangle = triangle;
  t.middle = (a + b + c) / 3;
  t.size = std::sqrt(
      std::max({(a - t.middle).squaredNorm(), (b - t.middle).squaredNorm(), (c - t.middle).squaredNorm()}));
  t.cross = (b - a).cross(c - a);
  t.cross_norm = t.cross.norm();
  t.is_duplicate = topology.is_duplicate(triangle);
  t.is_at_border = topology.is_at_border(triangle);
  t.has_free_node =
      std::any_of(node.begin(), node.end(), [&](std::uint32_t n) { return motion.inverse_mass[n] > 0; });
  if (!t.has_free_node && topology.is_closed(triangle)) t.closed_part = topology.part(triangle);
  return t;
}

}  // namespace

void TriangleCells::clear() {
  is_found_ = false;
  cells_.clear();
}

void TriangleCells::find(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
                         Span<const MeshTopology* const> topologies, Span<const TriangleList> near,
                         double support_radius, const Neighbours& neighbours, const Workers& workers) {
  OILSKIN_ASSERT(support_radius > 0 && neighbours.size() == x.size());
  OILSKIN_ASSERT(topologies.size() == surfaces.size());
  clear();
  is_found_ = true;
  read_triangles(surfaces, topologies, near, support_radius, workers);
  find_groups(x, neighbours, workers);
  const std::size_t chunks = (triangles_.size() + triangle_chunk - 1) / triangle_chunk;
  if (found_.size() < chunks) found_.resize(chunks);
  touches_.resize(triangles_.size());
  workers.for_chunks(triangles_.size(), triangle_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    std::vector<Touch>& found = found_[c];
    found.clear();
    std::vector<std::uint32_t> groups;
    const auto end = static_cast<std::uint32_t>(e);
    for (auto t = static_cast<std::uint32_t>(b); t < end;) {
      const std::uint32_t last = end_of_block(t, end, support_radius);
      groups_near(t, last, neighbours, groups);
      for (; t < last; ++t) {
        touches_[t].begin = static_cast<std::uint32_t>(found.size());
        for (std::uint32_t g : groups) {
          if (!boxes_[t].overlaps(groups_[g].box)) continue;
          const Sides sides = touch(x, t, groups_[g], support_radius);
          if (!sides.front && !sides.back) continue;
          found.push_back({g, t, sides});
          triangles_[t].sides.front |= sides.front;
          triangles_[t].sides.back |= sides.back;
        }
        touches_[t].end = static_cast<std::uint32_t>(found.size());
      }
    }
  });
  sort_by_cell(chunks, workers);
}

void TriangleCells::read_triangles(Span<SurfaceMotion* const> surfaces,
                                   Span<const MeshTopology* const> topologies, Span<const TriangleList> near,
                                   double support_radius, const Workers& workers) {
  std::size_t first = 0;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s)
    first += TriangleChoice(near, s, surfaces[s]->triangles.size()).size();
  triangles_.resize(first);  // not cleared before: what is overwritten need not be initialised
  corners_.resize(first);
  boxes_.resize(first);
  first = 0;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
    const SurfaceMotion& motion = *surfaces[s];
    OILSKIN_ASSERT(topologies[s]->triangle_count() == motion.triangles.size());
    const TriangleChoice chosen(near, s, motion.triangles.size());
    workers.for_each(chosen.size(), triangle_chunk, [&](std::size_t k) {
      triangles_[first + k] = triangle_of(motion, *topologies[s], s, chosen[k]);
      Box box;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3& node = motion.x_t0[motion.triangles[chosen[k]][corner]];
        Eigen::Map<Vec3>(corners_[first + k].x + 3 * corner) = node;
        box.add(node);
      }
      boxes_[first + k] = box.inflated(support_radius * rounding);
    });
    first += chosen.size();
  }
}

void TriangleCells::find_groups(Span<const Vec3> x, const Neighbours& neighbours, const Workers& workers) {
  const std::size_t cells = neighbours.cell_count();
  groups_.clear();
  group_of_.resize(cells);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (cell == 0 || neighbours.cell_group(cell, group_bits) != neighbours.cell_group(cell - 1, group_bits)) {
      groups_.emplace_back();
      groups_.back().begin = neighbours.cell_begin(cell);
    }
    groups_.back().end = neighbours.cell_begin(cell + 1);
    group_of_[cell] = static_cast<std::uint32_t>(groups_.size() - 1);
  }
  workers.for_each(groups_.size(), group_chunk, [&](std::size_t g) {
    for (std::uint32_t i = groups_[g].begin; i < groups_[g].end; ++i) groups_[g].box.add(x[i]);
  });
}

/// Finds the groups whose particles may be within H of the triangles `first` … `last` − 1, which are
/// neighbours.
void TriangleCells::groups_near(std::uint32_t first, std::uint32_t last, const Neighbours& neighbours,
                                std::vector<std::uint32_t>& groups) const {
  groups.clear();
  Box all;
  for (std::uint32_t t = first; t < last; ++t) all.add(boxes_[t]);
  neighbours.for_cells_in(all, [&](std::size_t begin, std::size_t end) {
    for (std::uint32_t g = group_of_[begin]; g <= group_of_[end - 1]; ++g) groups.push_back(g);
  });
}

/// The sides of the triangle on which particles of the group may be within H of its plane.
Sides TriangleCells::touch(Span<const Vec3> x, std::uint32_t triangle, const Cell& group,
                           double support_radius) const {
  const NearbyTriangle& t = triangles_[triangle];
  const Vec3 a = Eigen::Map<const Vec3>(corners_[triangle].x);
  const double reach = support_radius * rounding * t.cross_norm, tie = 1e-9 * reach;
  // Of particles between these heights. A height of nearly 0 counts as both.
  const auto sides = [&](double lowest, double highest) { return Sides{highest >= -tie, lowest <= tie}; };
  const Vec3 middle = 0.5 * (group.box.min + group.box.max);
  const Vec3 half = (group.box.max - middle).cwiseMax(middle - group.box.min);
  const double height = t.cross.dot(middle - a), extent = rounding * t.cross.cwiseAbs().dot(half);
  if (std::abs(height) - extent > reach) return {};
  if (std::abs(height) > extent) return sides(height - extent, height + extent);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::uint32_t i = group.begin; i < group.end; ++i) {
    const double side = t.cross.dot(x[i] - a);
    const bool is_near = std::abs(side) <= reach;
    lowest = is_near && side < lowest ? side : lowest;
    highest = is_near && side > highest ? side : highest;
  }
  return sides(lowest, highest);
}

/// The end of the triangles from `first` on that are looked at together.
std::uint32_t TriangleCells::end_of_block(std::uint32_t first, std::uint32_t end,
                                          double support_radius) const {
  end = std::min(end, first + block_size);
  Box all = boxes_[first];
  const Vec3 most = (all.max - all.min).array() + block_growth * support_radius;
  for (std::uint32_t t = first + 1; t < end; ++t) {
    all.add(boxes_[t]);
    if (((all.max - all.min).array() > most.array()).any()) return t;
  }
  return end;
}

void TriangleCells::sort_by_cell(std::size_t chunks, const Workers& workers) {
  const auto for_touches = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t c = begin; c < end; ++c)
      for (const Touch& touch : found_[c]) f(touch.group, touch.triangle);
  };
  sort_by_key(chunks, 4, groups_.size(), for_touches, workers, of_group_);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (of_group_.of(g).empty()) continue;
    cells_.push_back(groups_[g]);
    cells_.back().first = of_group_.begin[g];
    cells_.back().last = of_group_.begin[g + 1];
  }
}

}  // namespace oilskin::fluid
