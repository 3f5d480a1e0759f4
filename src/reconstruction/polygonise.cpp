#include "reconstruction/polygonise.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "reconstruction/cell_volume.h"
#include "reconstruction/cube_lattice.h"

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

/// How far it is from the inside end to the side of the clip box, in edges.
double fraction_in_clip(const Grid& grid, const VertexRef& v) {
  const NodeRef own = inside_end(grid, v);
  const Int3 b = grid.blocks[own.block].at;
  const int block[3] = {b.x, b.y, b.z};
  const double at = double(block[v.axis]) * side + (own.node >> 3 * v.axis & 7);
  return v.of_high_end ? at - grid.clip->min[v.axis] / grid.cell : grid.clip->max[v.axis] / grid.cell - at;
}

/// The same, off the ends of the edge.
double vertex_fraction(const Grid& grid, const VertexRef& v) {
  double fraction = fraction_from_inside_end(grid, v);
  if (grid.clip) fraction = std::min(fraction, fraction_in_clip(grid, v));
  return std::min(std::max(fraction, end_margin), 1 - end_margin);
}

/// The distance of a vertex from obstacles [cells], linear between the ends of its edge. `t`: its fraction.
float vertex_distance(const Grid& grid, const VertexRef& v, double t) {
  const NodeRef low{v.block, v.node}, high = high_end(grid, v);
  const double own = grid.distance(v.of_high_end ? high : low),
               other = grid.distance(v.of_high_end ? low : high);
  const std::uint32_t near = grid.blocks[v.block].near;
  if (const CutEdge* cut = near == none ? nullptr : grid.nears[near].find_cut(v.axis, v.node)) {
    const double crossing = v.of_high_end ? 1.0 - cut->last : double(cut->first);
    return static_cast<float>(own * std::max(0.0, 1 - t / std::max(crossing, 1e-6)));
  }
  return static_cast<float>(std::isfinite(own) && std::isfinite(other)
                                ? own + t * (other - own)
                                : std::numeric_limits<double>::infinity());
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

std::vector<std::uint32_t> blocks_with_surface(const Grid& grid, const Workers& workers) {
  std::vector<std::uint8_t> has_surface(grid.blocks.size());
  workers.for_chunks(grid.blocks.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t) {
    BlockRows rows;
    for (auto b = static_cast<std::uint32_t>(from); b < to; ++b) {
      rows.gather(grid, b);
      has_surface[b] = !rows.empty();
    }
  });
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
    if (has_surface[b]) blocks.push_back(b);
  return blocks;
}

template <class F>
void for_vertices(const VertexMasks& masks, std::uint32_t block, const F& f) {
  std::uint32_t number = 0;
  for (int w = 0; w < 48; ++w)
    for (std::uint64_t bits = masks.word[std::size_t(w)]; bits != 0; bits &= bits - 1, ++number)
      f(number,
        VertexRef{block, w % 8 * 64 + __builtin_ctzll(bits), static_cast<std::uint8_t>(w / 8 % 3), w >= 24});
}

/// Cells of a row whose corners are all inside, bit i.
unsigned full_cells(const BlockRows& rows, int j, int k) {
  const std::size_t r = std::size_t(j + 9 * k);
  const unsigned all = rows.inside[r] & rows.inside[r + 1] & rows.inside[r + 9] & rows.inside[r + 10];
  return all & all >> 1 & 0xff;
}

/// What the cells of some blocks give.
struct Cells {
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> cubes;
};

/// Makes the triangles of blocks.
class Triangulation {
 public:
  Triangulation(const Grid& grid, const std::vector<VertexMasks>& masks,
                const std::vector<std::uint32_t>& mask_of, const RawMesh& mesh)
      : grid_(grid), masks_(masks), mask_of_(mask_of), mesh_(mesh) {}

  void add(std::uint32_t block, const BlockRows& rows, std::vector<Triangle>& out) const {
    for_surface_cells(rows, [&](int i, int j, int k) {
      for_parts(rows.corners(i, j, k), rows.cuts(i, j, k),
                [&](std::uint8_t part) { add_part(part, numbers_of(block, i, j, k, part), out); });
    });
  }
  /// The same, with the cube of each triangle. Returns the water in the block's cubes. Needs the positions.
  std::array<float, 8> add_with_cubes(std::uint32_t block, const BlockRows& rows, Cells& out) const {
    std::array<double, 8> sum{};
    const Vec3 origin = grid_.origin(grid_.blocks[block]);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (unsigned bits = full_cells(rows, j, k); bits != 0; bits &= bits - 1)
          sum[cube_of(__builtin_ctz(bits), j, k)] += 1;
    for_surface_cells(rows, [&](int i, int j, int k) {
      const std::size_t cube = cube_of(i, j, k);
      if (full_cells(rows, j, k) >> i & 1) sum[cube] -= 1;
      const Vec3 corner = origin + grid_.cell * Vec3(i, j, k);
      for_all_parts(rows.corners(i, j, k), rows.cuts(i, j, k), [&](std::uint8_t part) {
        if (part == 0xff) {
          sum[cube] += 1;
          return;
        }
        const Numbers numbers = numbers_of(block, i, j, k, part);
        add_part(part, numbers, out.triangles);
        sum[cube] += volume_of(part, numbers, corner);
      });
      out.cubes.resize(out.triangles.size(), static_cast<std::uint8_t>(cube));
    });
    std::array<float, 8> result{};
    for (std::size_t c = 0; c < 8; ++c) result[c] = static_cast<float>(sum[c]);
    return result;
  }

 private:
  /// The vertices on the edges of a cell; those of edges without a vertex of the part are not set.
  using Numbers = std::array<std::uint32_t, 12>;

  /// As for_parts(), also the part of all corners.
  template <class F>
  static void for_all_parts(std::uint8_t inside, std::uint16_t cuts, const F& f) {
    for (unsigned left = inside; left != 0;) {
      const std::uint8_t part = cuts == 0 ? std::uint8_t{0xff} : part_of(__builtin_ctz(left), cuts);
      f(static_cast<std::uint8_t>(part & inside));
      left &= ~unsigned(part);
    }
  }
  static bool has_vertex(std::uint8_t part, int e) {
    const CellEdge& edge = cell_edges[std::size_t(e)];
    return (part >> edge.low & 1) != (part >> edge.high & 1);
  }
  static void add_part(std::uint8_t part, const Numbers& numbers, std::vector<Triangle>& out) {
    const CellCase& c = marching_cubes_table()[part];
    for (std::size_t t = 0; t < c.count; ++t) {
      const auto& edges = c.triangles[t];
      out.push_back({numbers[edges[0]], numbers[edges[1]], numbers[edges[2]]});
    }
  }
  double volume_of(std::uint8_t part, const Numbers& numbers, const Vec3& corner) const {
    std::array<Vec3, 12> at;
    const double per_cell = 1 / grid_.cell;
    for (int e = 0; e < 12; ++e)
      if (has_vertex(part, e))
        at[std::size_t(e)] = (vec(mesh_.positions[numbers[std::size_t(e)]]) - corner) * per_cell;
    return part_volume(part, at);
  }
  Numbers numbers_of(std::uint32_t block, int i, int j, int k, std::uint8_t part) const {
    Numbers numbers;
    for (int e = 0; e < 12; ++e)
      if (has_vertex(part, e)) numbers[std::size_t(e)] = number(cell_vertex(grid_, block, i, j, k, e, part));
    return numbers;
  }
  std::uint32_t number(const VertexRef& v) const {
    OILSKIN_ASSERT(v.block != none && mask_of_[v.block] != none);
    return mesh_.first_vertex[v.block] + masks_[mask_of_[v.block]].number(v);
  }

  const Grid& grid_;
  const std::vector<VertexMasks>& masks_;
  const std::vector<std::uint32_t>& mask_of_;
  const RawMesh& mesh_;
};

/// The water in the cubes of blocks without surface.
void fill_solid_blocks(const Grid& grid, const std::vector<std::uint32_t>& mask_of, RawMesh& mesh) {
  mesh.cube_volumes.assign(grid.blocks.size(), std::array<float, 8>{});
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
    if (mask_of[b] == none && grid.is_inside({b, 0})) mesh.cube_volumes[b].fill(64);
}

std::array<float, 3> position_at(const Grid& grid, const VertexRef& v, double fraction) {
  const double t = v.of_high_end ? 1 - fraction : fraction;
  const Int3 at = grid.blocks[v.block].at, s = step(v.axis);
  const double x = double(at.x) * side + (v.node & 7) + s.x * t,
               y = double(at.y) * side + (v.node >> 3 & 7) + s.y * t,
               z = double(at.z) * side + (v.node >> 6) + s.z * t;
  return {static_cast<float>(x * grid.cell), static_cast<float>(y * grid.cell),
          static_cast<float>(z * grid.cell)};
}

}  // namespace

std::array<float, 3> vertex_position(const Grid& grid, const VertexRef& v) {
  return position_at(grid, v, vertex_fraction(grid, v));
}

NodeRef inside_end(const Grid& grid, const VertexRef& v) {
  return v.of_high_end ? high_end(grid, v) : NodeRef{v.block, v.node};
}

SurfaceBlocks::SurfaceBlocks(const Grid& grid, const RawMesh& mesh) {
  OILSKIN_ASSERT(mesh.first_triangle.size() == grid.blocks.size() + 1);
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) {
    if (mesh.first_triangle[b] == mesh.first_triangle[b + 1]) continue;
    const Int3& at = grid.blocks[b].at;
    groups[std::size_t((at.x & 1) | (at.y & 1) << 1 | (at.z & 1) << 2)].push_back(b);
  }
}

namespace {

/// Positions, and all that is per vertex.
void place_vertices(const Grid& grid, const std::vector<std::uint32_t>& with_surface,
                    const std::vector<VertexMasks>& masks, bool with_nodes, RawMesh& mesh,
                    const Workers& workers) {
  mesh.positions.resize(mesh.first_vertex.back());
  if (with_nodes) mesh.inside_nodes.resize(mesh.positions.size());
  if (with_nodes) mesh.distances.resize(mesh.positions.size());
  workers.for_each(with_surface.size(), chunk, [&](std::size_t m) {
    const std::uint32_t b = with_surface[m], first = mesh.first_vertex[b];
    for_vertices(masks[m], b, [&](std::uint32_t number, const VertexRef& v) {
      const double t = vertex_fraction(grid, v);
      mesh.positions[first + number] = position_at(grid, v, t);
      if (!with_nodes) return;
      mesh.inside_nodes[first + number] = inside_end(grid, v);
      mesh.distances[first + number] = vertex_distance(grid, v, t);
    });
  });
}

/// Joins the triangles of chunks.
void append_triangles(std::vector<Cells>& found, RawMesh& mesh) {
  std::size_t total = 0;
  for (const Cells& part : found) total += part.triangles.size();
  mesh.triangles.reserve(total);
  if (!mesh.cube_volumes.empty()) mesh.triangle_cubes.reserve(total);
  for (Cells& part : found) {
    mesh.triangles.insert(mesh.triangles.end(), part.triangles.begin(), part.triangles.end());
    mesh.triangle_cubes.insert(mesh.triangle_cubes.end(), part.cubes.begin(), part.cubes.end());
    part = {};
  }
}

}  // namespace

void polygonise(const Grid& grid, bool with_nodes, const Workers& workers, RawMesh& mesh) {
  const std::vector<std::uint32_t> with_surface = blocks_with_surface(grid, workers);
  const std::size_t n = with_surface.size();
  std::vector<std::uint32_t> mask_of(grid.blocks.size(), none);
  for (std::size_t m = 0; m < n; ++m) mask_of[with_surface[m]] = static_cast<std::uint32_t>(m);
  std::vector<VertexMasks> masks(n);
  workers.for_each(n, chunk, [&](std::size_t m) {
    BlockRows rows;
    rows.gather(grid, with_surface[m]);
    masks[m].fill(rows);
  });

  mesh.clear();
  mesh.first_vertex.assign(grid.blocks.size() + 1, 0);
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
    mesh.first_vertex[b + 1] = mesh.first_vertex[b] + (mask_of[b] == none ? 0 : masks[mask_of[b]].count);
  place_vertices(grid, with_surface, masks, with_nodes, mesh, workers);
  if (with_nodes) fill_solid_blocks(grid, mask_of, mesh);
  const Triangulation triangulation(grid, masks, mask_of, mesh);
  std::vector<Cells> found((n + chunk - 1) / chunk);
  std::vector<std::uint32_t> count(n);
  workers.for_chunks(n, chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
    BlockRows rows;
    for (std::size_t m = from; m < to; ++m) {
      const std::uint32_t b = with_surface[m];
      const std::size_t before = found[c].triangles.size();
      rows.gather(grid, b);
      if (with_nodes)
        mesh.cube_volumes[b] = triangulation.add_with_cubes(b, rows, found[c]);
      else
        triangulation.add(b, rows, found[c].triangles);
      count[m] = static_cast<std::uint32_t>(found[c].triangles.size() - before);
    }
  });
  mesh.first_triangle.assign(grid.blocks.size() + 1, 0);
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
    mesh.first_triangle[b + 1] = mesh.first_triangle[b] + (mask_of[b] == none ? 0 : count[mask_of[b]]);
  append_triangles(found, mesh);
}

}  // namespace oilskin::reconstruction
