/// Makes triangles from signs: vertices lie on edges of the grid and belong to the edge and its inside end.
#pragma once

#include "reconstruction/cut_cells.h"

namespace oilskin::reconstruction {

/// The vertex on a grid edge that belongs to one of its ends. `node` is the low end in `block`, which owns
/// the edge. A cut edge with both ends inside has two vertices.
struct VertexRef {
  std::uint32_t block;
  int node;
  std::uint8_t axis;
  bool of_high_end;
};

/// The position as it is returned in the mesh.
std::array<float, 3> vertex_position(const Grid& grid, const VertexRef& v);

/// The vertex on edge `edge` of cell (i, j, k) for a part with the inside corners `part`.
inline VertexRef cell_vertex(const Grid& grid, std::uint32_t block, int i, int j, int k, int edge,
                             std::uint8_t part) {
  const CellEdge& e = cell_edges[std::size_t(edge)];
  const NodeRef low = corner_node(grid, block, i, j, k, e.low);
  return {low.block, low.node, e.axis, !(part >> e.low & 1)};
}

/// The inside end to which a vertex belongs.
NodeRef inside_end(const Grid& grid, const VertexRef& v);

struct RawMesh {
  std::vector<std::array<float, 3>> positions;
  std::vector<Triangle> triangles;
  /// Number of the first vertex of each block, and the number of vertices. Blocks own vertices in order.
  std::vector<std::uint32_t> first_vertex;
  /// The same for triangles, which belong to the blocks of their cells. Their vertices belong to the block
  /// and to its neighbours Block::plus.
  std::vector<std::uint32_t> first_triangle;
  /// Per triangle, the cube of 4³ cells of its block with its cell: x + 2y + 4z.
  std::vector<std::uint8_t> triangle_cubes;
  /// Per vertex, its inside end.
  std::vector<NodeRef> inside_nodes;
  /// Per vertex, its distance from obstacles [cells], linear between the ends of its edge.
  std::vector<float> distances;
  /// Per block, the water in its eight cubes of 4³ cells [cells³]; cube x + 2y + 4z.
  std::vector<std::array<float, 8>> cube_volumes;

  /// Empty, with the memory that it has.
  void clear() {
    positions.clear();
    triangles.clear();
    first_vertex.clear();
    first_triangle.clear();
    triangle_cubes.clear();
    inside_nodes.clear();
    distances.clear();
    cube_volumes.clear();
  }
};

/// Blocks with triangles. Blocks of a group share no vertex, so threads may write to the vertices of all
/// triangles of a group; groups in turn give sums in a fixed order.
struct SurfaceBlocks {
  std::array<std::vector<std::uint32_t>, 8> groups;

  SurfaceBlocks(const Grid& grid, const RawMesh& mesh);
  /// Calls f(block) for all blocks with triangles, group by group.
  template <class F>
  void for_each(const Workers& workers, const F& f) const {
    for (const std::vector<std::uint32_t>& group : groups)
      workers.for_each(group.size(), 8, [&](std::size_t n) { f(group[n]); });
  }
};

/// Fills the mesh, in the order of blocks. `with_nodes` fills all that is per vertex, triangle and cube.
void polygonise(const Grid& grid, bool with_nodes, const Workers& workers, RawMesh& mesh);

}  // namespace oilskin::reconstruction
