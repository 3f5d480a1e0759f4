/// From signs to triangles: vertices on edges of the grid, keyed by the edge and its end inside.
#pragma once

#include "reconstruction/cut_cells.h"

namespace oilskin::reconstruction {

/// The vertex on an edge of the grid that belongs to one of its ends. `node` is the low end in `block`, which
/// owns the edge. Both ends have one where an obstacle cuts the edge and both are inside.
struct VertexRef {
  std::uint32_t block;
  int node;
  std::uint8_t axis;
  bool of_high_end;
};

/// The position as it will be written.
std::array<float, 3> vertex_position(const Grid& grid, const VertexRef& v);

/// The vertex on edge `edge` of cell (i, j, k) of a part with these inside corners.
inline VertexRef cell_vertex(const Grid& grid, std::uint32_t block, int i, int j, int k, int edge,
                             std::uint8_t part) {
  const CellEdge& e = cell_edges[std::size_t(edge)];
  const NodeRef low = corner_node(grid, block, i, j, k, e.low);
  return {low.block, low.node, e.axis, !(part >> e.low & 1)};
}

/// The end inside to which a vertex belongs.
NodeRef inside_end(const Grid& grid, const VertexRef& v);

struct RawMesh {
  std::vector<std::array<float, 3>> positions;
  std::vector<Triangle> triangles;
  /// Of each block, the number of its first vertex: blocks own vertices in order, one more than blocks.
  std::vector<std::uint32_t> first_vertex;
  /// Of each vertex, the node inside to which it belongs.
  std::vector<NodeRef> inside_nodes;
};

/// The whole mesh, in the order of blocks; `with_nodes` fills inside_nodes.
RawMesh polygonise(const Grid& grid, bool with_nodes, const Workers& workers);

}  // namespace oilskin::reconstruction
