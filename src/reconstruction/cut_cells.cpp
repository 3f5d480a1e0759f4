#include "reconstruction/cut_cells.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::reconstruction {

namespace {

constexpr std::size_t chunk = 8;

/// The node with the smaller distance to obstacles; a if equal.
NodeRef nearer(const Grid& grid, NodeRef a, NodeRef b) {
  return grid.distance(b) < grid.distance(a) ? b : a;
}

}  // namespace

void BlockRows::gather(const Grid& grid, std::uint32_t block) {
  const Block& b = grid.blocks[block];
  inside = gather_rows(b, [&](std::uint32_t o, int k) { return grid.slice(o, k); });
  has_cuts = false;
  for (std::uint32_t o : b.plus)
    has_cuts |=
        o != none && grid.blocks[o].near != none && !grid.nears[grid.blocks[o].near].cut_edges.empty();
  if (!has_cuts) return;
  for (std::size_t a = 0; a < 3; ++a)
    cut[a] = gather_rows(b, [&](std::uint32_t o, int k) -> std::uint64_t {
      if (o == none || grid.blocks[o].near == none) return 0;
      return grid.nears[grid.blocks[o].near].cut[a][std::size_t(k)];
    });
}

bool BlockRows::empty() const {
  unsigned any = 0, all = 0x1ff;
  for (std::uint16_t row : inside) {
    any |= row;
    all &= row;
  }
  return any == 0 || (all == 0x1ff && !has_cuts);
}

std::uint8_t BlockRows::cells(int j, int k) const {
  const std::size_t r = std::size_t(j + 9 * k);
  const unsigned any = inside[r] | inside[r + 1] | inside[r + 9] | inside[r + 10];
  const unsigned all = inside[r] & inside[r + 1] & inside[r + 9] & inside[r + 10];
  const unsigned some = any | any >> 1;
  unsigned cells = some & ~(all & all >> 1);
  if (has_cuts) {
    const unsigned along_x = cut[0][r] | cut[0][r + 1] | cut[0][r + 9] | cut[0][r + 10];
    const unsigned across = cut[1][r] | cut[1][r + 9] | cut[2][r] | cut[2][r + 1];
    cells |= some & (along_x | across | across >> 1);
  }
  return static_cast<std::uint8_t>(cells);
}

std::uint8_t BlockRows::corners(int i, int j, int k) const {
  const std::size_t r = std::size_t(j + 9 * k);
  return static_cast<std::uint8_t>((inside[r] >> i & 3) | (inside[r + 1] >> i & 3) << 2 |
                                   (inside[r + 9] >> i & 3) << 4 | (inside[r + 10] >> i & 3) << 6);
}

std::uint16_t BlockRows::cuts(int i, int j, int k) const {
  if (!has_cuts) return 0;
  unsigned cuts = 0;
  for (unsigned e = 0; e < cell_edges.size(); ++e) {
    const int low = cell_edges[e].low;
    const std::size_t r = std::size_t(j + (low >> 1 & 1) + 9 * (k + (low >> 2 & 1)));
    cuts |= unsigned(cut[cell_edges[e].axis][r] >> (i + (low & 1)) & 1) << e;
  }
  return static_cast<std::uint16_t>(cuts);
}

std::uint8_t part_of(int corner, std::uint16_t cuts) {
  unsigned part = 1u << corner;
  for (unsigned before = 0; before != part;) {
    before = part;
    for (unsigned e = 0; e < cell_edges.size(); ++e) {
      if (cuts >> e & 1) continue;
      const unsigned ends = 1u << cell_edges[e].low | 1u << cell_edges[e].high;
      if (part & ends) part |= ends;
    }
  }
  return static_cast<std::uint8_t>(part);
}

std::size_t set_outside(Grid& grid, const std::vector<std::vector<NodeRef>>& found) {
  std::size_t count = 0;
  for (const auto& part : found)
    for (const NodeRef& n : part) {
      if (!grid.is_inside(n)) continue;
      grid.set_outside(n, cleared_value);
      ++count;
    }
  return count;
}

std::size_t clear_joined_edges(Grid& grid, const Workers& workers) {
  std::vector<std::vector<NodeRef>> found((grid.blocks.size() + chunk - 1) / chunk);
  workers.for_chunks(grid.blocks.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
    BlockRows rows;
    for (auto b = static_cast<std::uint32_t>(from); b < to; ++b) {
      if (grid.blocks[b].near == none) continue;
      rows.gather(grid, b);
      if (!rows.has_cuts || rows.empty()) continue;
      for_surface_cells(rows, [&](int i, int j, int k) {
        const std::uint16_t cuts = rows.cuts(i, j, k);
        const std::uint8_t inside = rows.corners(i, j, k);
        for (unsigned e = 0; e < cell_edges.size(); ++e) {
          const CellEdge& edge = cell_edges[e];
          if (!(cuts >> e & 1) || !(inside >> edge.low & 1) || !(inside >> edge.high & 1)) continue;
          if (!(part_of(edge.low, cuts) >> edge.high & 1)) continue;
          found[c].push_back(nearer(grid, corner_node(grid, b, i, j, k, edge.low),
                                    corner_node(grid, b, i, j, k, edge.high)));
        }
      });
    }
  });
  return set_outside(grid, found);
}

}  // namespace oilskin::reconstruction
