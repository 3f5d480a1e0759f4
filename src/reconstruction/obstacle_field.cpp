#include "reconstruction/obstacle_field.h"

#include <algorithm>

#include "core/assert.h"
#include "reconstruction/film.h"
#include "reconstruction/pieces.h"
#include "reconstruction/smoothing.h"
#include "reconstruction/water.h"

namespace oilskin::reconstruction {

namespace {

constexpr double pi = 3.14159265358979323846;

/// The aimed distance exceeds the gap by this [cells], so that bends of a sheet leave little to repair.
constexpr double clearance_margin = 0.15;

/// A node nearer than this is on the obstacle, up to rounding [cells].
constexpr float on_obstacle = 1e-4f;

/// WetRule::fade as a fraction of the touch range: small, since a dry layer may lie over a wet one.
constexpr double fade_of_range = 0.25;

struct CellAt {
  std::uint32_t block = none;
  int i = 0, j = 0, k = 0;
};

CellAt cell_at(const Grid& grid, const Vec3& x) {
  const Vec3 q = x / grid.cell;
  if (!(q.cwiseAbs().maxCoeff() < 0x1p21)) return {};
  const int i = static_cast<int>(std::floor(q.x())), j = static_cast<int>(std::floor(q.y())),
            k = static_cast<int>(std::floor(q.z()));
  return {grid.index.find(key_of({i >> 3, j >> 3, k >> 3})), i & 7, j & 7, k & 7};
}

std::uint8_t inside_corners(const Grid& grid, const CellAt& c) {
  unsigned inside = 0;
  for (int corner = 0; corner < 8; ++corner)
    inside |= unsigned(grid.is_inside(corner_node(grid, c.block, c.i, c.j, c.k, corner))) << corner;
  return static_cast<std::uint8_t>(inside);
}

/// Mode `wet` measures distances as `touch` does, and triangles a little farther out have an influence.
void set_wet_rule(const ReconstructionOptions& o, ContactParameters& p) {
  p.wet.wet_from = o.wet_saturation;
  p.wet.dry_to = (1 - o.wet_blend) * o.wet_saturation;
  // Films reach farther than `touch` does, which needs no wetness beyond its range.
  p.wet.range = keeps_volume(o) && p.touch_range > 0 ? std::max(p.touch_range, p.band) : p.touch_range;
  p.wet.fade = fade_of_range * p.touch_range;
  p.band = std::max(p.band, p.touch_range);
  p.reach = std::max(p.reach, p.wet.range + p.wet.fade + 2 * on_obstacle);
}

}  // namespace

ContactParameters contact_parameters(const ReconstructionOptions& o) {
  ContactParameters p;
  const double cell = o.cell * o.spacing;
  p.mode = o.contact;
  p.gap = o.gap;
  p.clearance = o.gap / cell + clearance_margin;
  p.touch_range = o.touch_range / o.cell;
  p.depth = o.overlap_depth / cell;
  if (o.contact == ObstacleMode::reset) p.clearance = std::max(o.gap / cell, 0.5);
  // touch needs distances up to its range, overlap also at neighbours of the nodes that it changes.
  p.band = p.clearance + 1.25;
  if (keeps_volume(o) && p.promises()) p.band = std::max(p.band, film_band(o, p.clearance));
  if (o.contact == ObstacleMode::touch) p.band = std::max(p.band, p.touch_range);
  if (o.contact == ObstacleMode::overlap) p.band = std::max(p.band, std::max(p.touch_range, p.depth) + 1);
  // For visibility, for distances, and for corners that repair may set outside, which must have values.
  p.reach = std::max({o.kernel_radius / o.cell, p.band, o.gap / cell + 1.8});
  if (o.contact == ObstacleMode::wet) set_wet_rule(o, p);
  return p;
}

float value_at_contact(const ContactParameters& p, float visible, float all, float distance, float wetness) {
  OILSKIN_ASSERT(distance >= 0);
  const auto clearance = static_cast<float>(p.clearance), range = static_cast<float>(p.touch_range);
  // A node on an obstacle sees no particle. The surface passes it at the clearance, as it does beside it.
  if (p.promises() && distance < on_obstacle) return clearance;
  const float drawn = distance < range ? visible - (range - distance) : visible;
  switch (p.mode) {
    case ObstacleMode::none:
      break;
    case ObstacleMode::reset:
      return distance < clearance ? std::max(visible, cleared_value) : visible;
    case ObstacleMode::gap:
      return std::max(visible, clearance - distance);
    case ObstacleMode::touch:
      return std::max(drawn, clearance - distance);
    case ObstacleMode::wet:
      return (1 - wetness) * std::max(visible, clearance - distance) +
             wetness * std::max(drawn, clearance - distance);
    case ObstacleMode::overlap:
      return std::min(drawn, std::max(distance - static_cast<float>(p.depth), all - distance - range));
  }
  return visible;
}

bool is_submerged(const Obstacles& obstacles, const std::vector<std::uint32_t>& piece, const Grid& grid,
                  InsideTest& inside) {
  OILSKIN_ASSERT(!piece.empty());
  for (std::uint32_t v : piece) {
    const CellAt c = cell_at(grid, obstacles.vertex(v));
    // A cell without inside corners has no surface and is outside.
    if (c.block == none || inside_corners(grid, c) == 0) return false;
  }
  return inside.has(obstacles.vertex(piece[0]));
}

namespace {

/// Where triangles have passed that moved by more than a cell. Nearer ones are found by the grid.
std::vector<Box> boxes_of_long_moves(const std::vector<std::array<float, 3>>& start,
                                     const std::vector<std::uint32_t>& moved, const RawMesh& mesh,
                                     double cell) {
  std::vector<Box> boxes;
  for (const std::uint32_t t : moved) {
    Box box;
    bool is_long = false;
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Vec3 from = vec(start[v]), to = vec(mesh.positions[v]);
      box.add(from);
      box.add(to);
      is_long |= (to - from).norm() > cell;
    }
    if (is_long) boxes.push_back(box);
  }
  return boxes;
}

/// Puts the vertices back that started in the box or are in it now. Returns their number.
std::size_t put_back_in(const Box& box, const std::vector<std::array<float, 3>>& start, RawMesh& mesh) {
  std::size_t vertices = 0;
  for (std::size_t v = 0; v < start.size(); ++v) {
    if (mesh.positions[v] == start[v]) continue;
    if (!box.contains(vec(start[v])) && !box.contains(vec(mesh.positions[v]))) continue;
    mesh.positions[v] = start[v];
    ++vertices;
  }
  return vertices;
}

}  // namespace

std::size_t put_back_around_enclosed(const Obstacles& obstacles, const Grid& grid,
                                     const std::vector<std::array<float, 3>>& start,
                                     const std::vector<std::uint32_t>& moved, RawMesh& mesh) {
  const std::vector<Box> swept = boxes_of_long_moves(start, moved, mesh, grid.cell);
  std::size_t vertices = 0;
  InsideTest inside(mesh.positions, mesh.triangles);
  for (const std::vector<std::uint32_t>& piece : obstacles.pieces()) {
    Box box;
    for (const std::uint32_t v : piece) box.add(obstacles.vertex(v));
    const bool is_near =
        std::all_of(piece.begin(), piece.end(),
                    [&](std::uint32_t v) { return is_near_water(grid, obstacles.vertex(v) / grid.cell); }) ||
        std::any_of(swept.begin(), swept.end(), [&](const Box& b) { return b.overlaps(box); });
    if (!is_near) continue;
    // With all vertices at their start it is outside; no grid is wider than the last margin.
    for (double margin = 4 * grid.cell; margin < 0x1p24 * grid.cell && inside.has(obstacles.vertex(piece[0]));
         margin *= 2) {
      vertices += put_back_in(box.inflated(margin), start, mesh);
      inside.reset();
    }
  }
  return vertices;
}

std::vector<NodeRef> nodes_around(const Vec3& x, const Grid& grid) {
  const CellAt c = cell_at(grid, x);
  std::vector<NodeRef> found;
  if (c.block == none) return found;
  for (int corner = 0; corner < 8; ++corner) {
    const NodeRef n = corner_node(grid, c.block, c.i, c.j, c.k, corner);
    if (grid.is_inside(n)) found.push_back(n);
  }
  return found;
}

}  // namespace oilskin::reconstruction
