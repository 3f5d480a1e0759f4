#include "reconstruction/repair.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "oilskin/surface_motion.h"

namespace oilskin::reconstruction {

namespace {

constexpr std::size_t chunk = 4;

/// The triangles near a block's cells, prepared for the tests.
class NearTriangles {
 public:
  void set(const Obstacles& obstacles, const NearBlock& near, double gap, const Box& cells) {
    items_.clear();
    for (std::uint32_t t : near.triangles) {
      Item item;
      item.corners = obstacles.corners(t);
      for (const Vec3& x : item.corners) item.box.add(x);
      item.limit = gap + obstacles.rounding(t);
      item.box = item.box.inflated(item.limit * (1 + 1e-9));
      if (!item.box.overlaps(cells)) continue;
      item.project_on_normal();
      items_.push_back(item);
    }
  }
  /// Selects those whose inflated boxes overlap the box.
  void select(const Box& box) {
    selected_.clear();
    for (const Item& item : items_)
      if (item.box.overlaps(box)) selected_.push_back(&item);
  }
  bool any_selected() const { return !selected_.empty(); }
  bool too_close(const Corners& t) const {
    Box box;
    for (const Vec3& x : t) box.add(x);
    for (const Item* item : selected_)
      if (item->box.overlaps(box) && !item->is_off_plane(t) &&
          !certified_apart(t, item->corners, item->limit))
        return true;
    return false;
  }

 private:
  struct Item {
    Corners corners;
    Box box;
    double limit;
    Vec3 normal;
    double low, high;  ///< interval of the corners along the normal, from the first one, widened by the limit

    void project_on_normal() {
      const Vec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0];
      normal = ab.cross(ac);
      const double length = normal.norm();
      if (length > 0) normal /= length;
      const double b = normal.dot(ab), c = normal.dot(ac);
      // Exceeds the rounding term of certified_apart().
      const double clear = limit * (1 + 1e-9) + 1e-12 * (box.max - box.min).maxCoeff();
      low = std::min({0.0, b, c}) - clear;
      high = std::max({0.0, b, c}) + clear;
    }
    /// The first direction of certified_apart(), which suffices for most triangles.
    bool is_off_plane(const Corners& t) const {
      const double a = normal.dot(t[0] - corners[0]), b = normal.dot(t[1] - corners[0]),
                   c = normal.dot(t[2] - corners[0]);
      return std::min({a, b, c}) > high || std::max({a, b, c}) < low;
    }
  };
  std::vector<Item> items_;
  std::vector<const Item*> selected_;
};

/// The vertices of a cell's triangles as they are returned in the mesh.
struct CellVertices {
  std::array<Vec3, 12> at;
  std::array<VertexRef, 12> ref;

  void set(const Grid& grid, std::uint32_t block, int i, int j, int k, std::uint8_t part, const CellCase& c) {
    unsigned done = 0;
    for (std::size_t t = 0; t < c.count; ++t)
      for (std::uint8_t e : c.triangles[t]) {
        if (done >> e & 1) continue;
        done |= 1u << e;
        ref[e] = cell_vertex(grid, block, i, j, k, e, part);
        const auto p = vertex_position(grid, ref[e]);
        // stored(): the compiler must not keep more digits than the mesh has.
        at[e] = stored(Vec3(p[0], p[1], p[2]), Storage::float32);
      }
  }
};

/// Of the inside corners on which a triangle depends, the nearest to an obstacle.
NodeRef nearest_end(const Grid& grid, const CellVertices& v, const std::array<std::uint8_t, 3>& edges) {
  NodeRef best;
  float min_distance = 0;
  for (std::uint8_t e : edges) {
    const NodeRef n = inside_end(grid, v.ref[e]);
    const float d = grid.distance(n);
    if (best.block == none || d < min_distance ||
        (d == min_distance && (n.block < best.block || (n.block == best.block && n.node < best.node)))) {
      best = n;
      min_distance = d;
    }
  }
  return best;
}

/// Appends a node to set outside for each triangle of block b that is too close to an obstacle.
void find_nodes_to_clear(const Obstacles& obstacles, double gap, const Grid& grid, std::uint32_t b,
                         BlockRows& rows, NearTriangles& near, std::vector<NodeRef>& found) {
  if (grid.blocks[b].near == none) return;
  rows.gather(grid, b);
  if (rows.empty()) return;
  const Vec3 origin = grid.origin(grid.blocks[b]);
  // Rounding to float may move a vertex out of its cell by an ulp.
  const auto cells = [&](const Vec3& low, double count) {
    return Box{low, low + Vec3::Constant(count * grid.cell)}.inflated(0.01 * grid.cell);
  };
  near.set(obstacles, grid.nears[grid.blocks[b].near], gap, cells(origin, side));
  CellVertices vertices;
  for_surface_cells(rows, [&](int i, int j, int k) {
    near.select(cells(origin + grid.cell * Vec3(i, j, k), 1));
    if (!near.any_selected()) return;
    for_parts(rows.corners(i, j, k), rows.cuts(i, j, k), [&](std::uint8_t part) {
      const CellCase& c = marching_cubes_table()[part];
      vertices.set(grid, b, i, j, k, part, c);
      for (std::size_t t = 0; t < c.count; ++t) {
        const auto& e = c.triangles[t];
        if (near.too_close({vertices.at[e[0]], vertices.at[e[1]], vertices.at[e[2]]}))
          found.push_back(nearest_end(grid, vertices, e));
      }
    });
  });
}

}  // namespace

std::vector<std::uint32_t> blocks_around(const Grid& grid, const std::vector<NodeRef>& changed) {
  std::vector<std::uint32_t> blocks;
  for (const NodeRef& n : changed) {
    // Bit per axis: the node is on the low face of its block, so cells of the block before it have it, too.
    const int low_faces = (n.node & 7 ? 0 : 1) | (n.node >> 3 & 7 ? 0 : 2) | (n.node >> 6 ? 0 : 4);
    for (int o = 0; o < 8; ++o) {
      if ((o & low_faces) != o) continue;
      const std::uint32_t b =
          grid.index.find(key_of(grid.blocks[n.block].at - Int3{o & 1, o >> 1 & 1, o >> 2 & 1}));
      if (b != none) blocks.push_back(b);
    }
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

RepairReport repair(const Obstacles& obstacles, double gap, Grid& grid, std::vector<std::uint32_t> only,
                    const Workers& workers) {
  OILSKIN_ASSERT(gap >= 0);
  RepairReport report;
  if (only.empty())
    for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
      if (grid.blocks[b].near != none) only.push_back(b);
  while (!only.empty()) {
    std::vector<std::vector<NodeRef>> found((only.size() + chunk - 1) / chunk);
    workers.for_chunks(only.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
      BlockRows rows;
      NearTriangles near;
      for (std::size_t k = from; k < to; ++k)
        find_nodes_to_clear(obstacles, gap, grid, only[k], rows, near, found[c]);
    });
    ++report.rounds;
    std::vector<NodeRef> changed;
    for (const auto& part : found) changed.insert(changed.end(), part.begin(), part.end());
    const std::size_t count = set_outside(grid, found);
    OILSKIN_ASSERT((count == 0) == changed.empty());
    report.nodes += count;
    only = blocks_around(grid, changed);
  }
  return report;
}

}  // namespace oilskin::reconstruction
