#include "reconstruction/polygonise.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::reconstruction {

namespace {

constexpr std::size_t chunk = 8;

/// Vertices stay this fraction of an edge away from its ends, so that no two coincide.
constexpr double end_margin = 0.01;

Int3 step(int axis) {
  return {axis == 0, axis == 1, axis == 2};
}

NodeRef high_end(const Grid& grid, const VertexRef& v) {
  const Int3 s = step(v.axis);
  return grid.node(v.block, (v.node & 7) + s.x, (v.node >> 3 & 7) + s.y, (v.node >> 6) + s.z);
}

/// Position of the vertex as a fraction of the edge from its inside end, (R.15) and (R.16).
double fraction_from_inside_end(const Grid& grid, const VertexRef& v) {
  const NodeRef low{v.block, v.node}, high = high_end(grid, v);
  const NodeRef own = v.of_high_end ? high : low, other = v.of_high_end ? low : high;
  const double here = grid.value(own);
  OILSKIN_ASSERT(grid.is_inside(own));
  const std::uint32_t near = grid.blocks[v.block].near;
  const CutEdge* cut = near == none ? nullptr : grid.nears[near].find_cut(v.axis, v.node);
  if (!cut) return here / (here - grid.value(other));
  // Behind the obstacle the value continues like the distance. For a plane sheet the distance decreases
  // linearly to zero at the crossing.
  const double clearance = grid.clearance;
  const double behind = clearance + std::min<double>(grid.distance(other), 2.0);
  const double crossing = v.of_high_end ? 1.0 - cut->last : double(cut->first);
  const double own_distance = grid.distance(own);
  return std::min(here / (here - behind), crossing * std::max(0.0, 1 - clearance / own_distance));
}

/// The vertices of a block, by edge and end, and their numbers. Words [end][axis][slice].
struct VertexMasks {
  std::array<std::uint64_t, 48> word{};
  std::array<std::uint16_t, 48> before{};
  std::uint32_t count = 0;

  static std::size_t slot(bool of_high_end, int axis, int slice) {
    return std::size_t((of_high_end ? 24 : 0) + 8 * axis + slice);
  }
  void fill(const BlockRows& rows) {
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < side; ++k)
        for (int j = 0; j < side; ++j) {
          const std::size_t r = std::size_t(j + 9 * k);
          const unsigned in = rows.inside[r];
          const unsigned next = axis == 0 ? in >> 1 : rows.inside[axis == 1 ? r + 1 : r + 9];
          const unsigned cut = rows.has_cuts ? rows.cut[std::size_t(axis)][r] : 0;
          word[slot(false, axis, k)] |= std::uint64_t(in & (~next | cut) & 0xff) << side * j;
          word[slot(true, axis, k)] |= std::uint64_t(next & (~in | cut) & 0xff) << side * j;
        }
    for (std::size_t w = 0; w < word.size(); ++w) {
      before[w] = static_cast<std::uint16_t>(count);
      count += static_cast<std::uint32_t>(__builtin_popcountll(word[w]));
    }
  }
  std::uint32_t number(const VertexRef& v) const {
    const std::size_t w = slot(v.of_high_end, v.axis, v.node >> 6);
    const std::uint64_t bit = 1ull << (v.node & 63);
    OILSKIN_ASSERT(word[w] & bit);
    return before[w] + static_cast<std::uint32_t>(__builtin_popcountll(word[w] & (bit - 1)));
  }
};

template <class F>
void for_vertices(const VertexMasks& masks, std::uint32_t block, const F& f) {
  std::uint32_t number = 0;
  for (int w = 0; w < 48; ++w)
    for (std::uint64_t bits = masks.word[std::size_t(w)]; bits != 0; bits &= bits - 1, ++number)
      f(number,
        VertexRef{block, w % 8 * 64 + __builtin_ctzll(bits), static_cast<std::uint8_t>(w / 8 % 3), w >= 24});
}

void add_triangles(const Grid& grid, std::uint32_t block, const BlockRows& rows,
                   const std::vector<VertexMasks>& masks, const std::vector<std::uint32_t>& mask_of,
                   const std::vector<std::uint32_t>& first, std::vector<Triangle>& out) {
  const auto& table = marching_cubes_table();
  for_surface_cells(rows, [&](int i, int j, int k) {
    for_parts(rows.corners(i, j, k), rows.cuts(i, j, k), [&](std::uint8_t part) {
      const CellCase& c = table[part];
      for (std::size_t t = 0; t < c.count; ++t) {
        Triangle triangle;
        for (std::size_t n = 0; n < 3; ++n) {
          const VertexRef v = cell_vertex(grid, block, i, j, k, c.triangles[t][n], part);
          OILSKIN_ASSERT(v.block != none && mask_of[v.block] != none);
          triangle[n] = first[v.block] + masks[mask_of[v.block]].number(v);
        }
        out.push_back(triangle);
      }
    });
  });
}

}  // namespace

std::array<float, 3> vertex_position(const Grid& grid, const VertexRef& v) {
  const double fraction = std::min(std::max(fraction_from_inside_end(grid, v), end_margin), 1 - end_margin);
  const double t = v.of_high_end ? 1 - fraction : fraction;
  const Int3 at = grid.blocks[v.block].at, s = step(v.axis);
  const double x = double(at.x) * side + (v.node & 7) + s.x * t,
               y = double(at.y) * side + (v.node >> 3 & 7) + s.y * t,
               z = double(at.z) * side + (v.node >> 6) + s.z * t;
  return {static_cast<float>(x * grid.cell), static_cast<float>(y * grid.cell),
          static_cast<float>(z * grid.cell)};
}

NodeRef inside_end(const Grid& grid, const VertexRef& v) {
  return v.of_high_end ? high_end(grid, v) : NodeRef{v.block, v.node};
}

RawMesh polygonise(const Grid& grid, bool with_nodes, const Workers& workers) {
  std::vector<std::uint8_t> has_surface(grid.blocks.size());
  workers.for_chunks(grid.blocks.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t) {
    BlockRows rows;
    for (auto b = static_cast<std::uint32_t>(from); b < to; ++b) {
      rows.gather(grid, b);
      has_surface[b] = !rows.empty();
    }
  });
  std::vector<std::uint32_t> with_surface, mask_of(grid.blocks.size(), none);
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) {
    if (!has_surface[b]) continue;
    mask_of[b] = static_cast<std::uint32_t>(with_surface.size());
    with_surface.push_back(b);
  }
  const std::size_t n = with_surface.size();
  std::vector<VertexMasks> masks(n);
  workers.for_each(n, chunk, [&](std::size_t m) {
    BlockRows rows;
    rows.gather(grid, with_surface[m]);
    masks[m].fill(rows);
  });

  RawMesh mesh;
  mesh.first_vertex.assign(grid.blocks.size() + 1, 0);
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
    mesh.first_vertex[b + 1] = mesh.first_vertex[b] + (mask_of[b] == none ? 0 : masks[mask_of[b]].count);
  mesh.positions.resize(mesh.first_vertex.back());
  if (with_nodes) mesh.inside_nodes.resize(mesh.positions.size());
  std::vector<std::vector<Triangle>> found((n + chunk - 1) / chunk);
  workers.for_chunks(n, chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
    BlockRows rows;
    for (std::size_t m = from; m < to; ++m) {
      const std::uint32_t b = with_surface[m];
      for_vertices(masks[m], b, [&](std::uint32_t number, const VertexRef& v) {
        mesh.positions[mesh.first_vertex[b] + number] = vertex_position(grid, v);
        if (with_nodes) mesh.inside_nodes[mesh.first_vertex[b] + number] = inside_end(grid, v);
      });
      rows.gather(grid, b);
      add_triangles(grid, b, rows, masks, mask_of, mesh.first_vertex, found[c]);
    }
  });
  std::size_t total = 0;
  for (const auto& part : found) total += part.size();
  mesh.triangles.reserve(total);
  for (auto& part : found) {
    mesh.triangles.insert(mesh.triangles.end(), part.begin(), part.end());
    std::vector<Triangle>().swap(part);
  }
  return mesh;
}

}  // namespace oilskin::reconstruction
