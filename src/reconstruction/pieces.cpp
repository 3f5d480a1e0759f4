#include "reconstruction/pieces.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/disjoint_sets.h"
#include "reconstruction/blobs.h"
#include "reconstruction/turned_parts.h"
#include "reconstruction/visibility.h"

namespace oilskin::reconstruction {

namespace {

std::uint64_t key_of_node(const NodeRef& n) {
  return std::uint64_t(n.block) << 9 | std::uint64_t(n.node);
}

}  // namespace

MeshParts parts_of(const RawMesh& mesh, const std::vector<std::array<float, 3>>& positions,
                   const Workers& workers) {
  const std::size_t n = positions.size();
  OILSKIN_ASSERT(n == mesh.positions.size());
  DisjointSets sets(n);
  for (const Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
  }
  MeshParts parts;
  parts.of_vertex.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) parts.of_vertex[v] = sets.find(v);  // its smallest vertex
  const std::vector<double> volume = part_volumes(positions, mesh.triangles, parts.of_vertex, workers);
  parts.is_bubble.resize(n);
  for (std::size_t v = 0; v < n; ++v) parts.is_bubble[v] = parts.of_vertex[v] == v && !(volume[v] > 0);
  return parts;
}

namespace {

/// Is there a piece of an obstacle inside the part that would be in the water without it?
bool keeps_obstacle_dry(const RawMesh& mesh, const MeshParts& parts, std::uint32_t part,
                        const Obstacles& obstacles, const TurnedParts& turned) {
  Box box;
  for (std::uint32_t v = part; v < mesh.positions.size(); ++v)
    if (parts.of_vertex[v] == part) box.add(vec(mesh.positions[v]));
  const auto is_kept_dry = [&](const std::vector<std::uint32_t>& piece) {
    return std::all_of(piece.begin(), piece.end(),
                       [&](std::uint32_t v) { return box.contains(obstacles.vertex(v)); }) &&
           turned.is_in_water(obstacles.vertex(piece[0]));
  };
  const auto& pieces = obstacles.pieces();
  return std::any_of(pieces.begin(), pieces.end(), is_kept_dry);
}

}  // namespace

void remove_turned_parts(const MeshParts& parts, const Obstacles& obstacles, const Workers& workers,
                         RawMesh& mesh, std::vector<float>& of_vertex) {
  OILSKIN_ASSERT(of_vertex.size() == mesh.positions.size());
  const std::vector<double> volume = part_volumes(mesh.positions, mesh.triangles, parts.of_vertex, workers);
  std::vector<std::uint8_t> turned(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < turned.size(); ++v)
    if (parts.of_vertex[v] == v) turned[v] = parts.is_bubble[v] ? volume[v] >= 0 : volume[v] <= 0;
  for (std::size_t v = 0; v < turned.size(); ++v)
    if (std::isfinite(mesh.distances[v])) turned[parts.of_vertex[v]] = 0;
  const TurnedParts in_air(mesh.positions, mesh.triangles, parts.of_vertex, volume, workers);
  for (const std::uint32_t p : in_air.numbers())
    if (!keeps_obstacle_dry(mesh, parts, p, obstacles, in_air)) turned[p] = 1;
  for (std::size_t v = 0; v < turned.size(); ++v) turned[v] = turned[parts.of_vertex[v]];
  if (std::find(turned.begin(), turned.end(), 1) == turned.end()) return;
  std::size_t kept = 0;
  for (std::size_t v = 0; v < turned.size(); ++v)
    if (!turned[v]) of_vertex[kept++] = of_vertex[v];
  of_vertex.resize(kept);
  remove_vertices(turned, mesh);
}

SmallPieces small_pieces(const RawMesh& mesh, const MeshParts& parts, double max_volume,
                         const Workers& workers) {
  const std::vector<double> volume = part_volumes(mesh.positions, mesh.triangles, parts.of_vertex, workers);
  SmallPieces pieces;
  pieces.of_vertex.assign(mesh.positions.size(), none);
  for (std::uint32_t v = 0; v < pieces.of_vertex.size(); ++v) {
    const std::uint32_t p = parts.of_vertex[v];
    if (parts.is_bubble[p]) pieces.in_bubbles.push_back(v);
    if (parts.is_bubble[p] || !(volume[p] < max_volume)) continue;
    pieces.of_vertex[v] = v == p ? pieces.count++ : pieces.of_vertex[p];
  }
  return pieces;
}

PieceFinder::PieceFinder(const Grid& grid, const Obstacles& obstacles, const RawMesh& mesh,
                         const SmallPieces& pieces)
    : grid_(grid), obstacles_(obstacles), is_near_(grid.blocks.size(), 0) {
  if (pieces.count == 0) return;
  std::vector<NodeRef> reached;
  for (std::size_t v = 0; v < mesh.inside_nodes.size(); ++v)
    if (pieces.of_vertex[v] != none) add(mesh.inside_nodes[v], pieces.of_vertex[v], reached);
  // Deeper nodes have no vertex.
  while (!reached.empty()) {
    const NodeRef node = reached.back();
    reached.pop_back();
    const std::uint32_t piece = piece_of_node_.find(key_of_node(node));
    for (int axis = 0; axis < 3; ++axis)
      for (const bool up : {false, true}) {
        const NodeRef other = next(node, axis, up);
        if (other.block != none && grid_.is_inside(other) && !is_cut(up ? node : other, axis))
          add(other, piece, reached);
      }
  }
}

std::uint32_t PieceFinder::of_node(const NodeRef& node) const {
  return piece_of_node_.find(key_of_node(node));
}

void PieceFinder::add(const NodeRef& node, std::uint32_t piece, std::vector<NodeRef>& reached) {
  const std::size_t before = piece_of_node_.size();
  piece_of_node_.insert(key_of_node(node), piece);
  if (piece_of_node_.size() == before) return;
  reached.push_back(node);
  mark_near(node);
}

/// A point is within two nodes of that to which it belongs.
void PieceFinder::mark_near(const NodeRef& node) {
  is_near_[node.block] = 1;
  const int at[3] = {node.node & 7, node.node >> 3 & 7, node.node >> 6};
  int step[3];
  for (int a = 0; a < 3; ++a) step[a] = at[a] < 2 ? -1 : (at[a] >= side - 2 ? 1 : 0);
  for (int c = 1; c < 8; ++c) {
    const Int3 to{c & 1 ? step[0] : 0, c & 2 ? step[1] : 0, c & 4 ? step[2] : 0};
    if (to == Int3{}) continue;
    const std::uint32_t b = grid_.index.find(key_of(grid_.blocks[node.block].at + to));
    if (b != none) is_near_[b] = 1;
  }
}

NodeRef PieceFinder::next(const NodeRef& node, int axis, bool up) const {
  const int shift = 3 * axis, along = node.node >> shift & 7, step = up ? 1 : -1;
  if (along + step >= 0 && along + step < side) return {node.block, node.node + step * (1 << shift)};
  const Int3 b = grid_.blocks[node.block].at;
  return grid_.node_at({b.x * side + (node.node & 7) + (axis == 0 ? step : 0),
                        b.y * side + (node.node >> 3 & 7) + (axis == 1 ? step : 0),
                        b.z * side + (node.node >> 6) + (axis == 2 ? step : 0)});
}

bool PieceFinder::is_cut(const NodeRef& low, int axis) const {
  const std::uint32_t near = grid_.blocks[low.block].near;
  return near != none && grid_.nears[near].find_cut(axis, low.node);
}

/// Obstacles that may lie between x and a node within two cells of it.
std::vector<std::uint32_t> PieceFinder::triangles_around(const Vec3& x) const {
  std::vector<std::uint32_t> found;
  const std::uint32_t b = grid_.index.find(key_of(block_at(x)));
  if (b == none || grid_.blocks[b].near == none) return found;
  Box box;
  box.add(x * grid_.cell);
  box = box.inflated(2 * grid_.cell);
  for (const std::uint32_t t : grid_.nears[grid_.blocks[b].near].triangles)
    if (obstacles_.box(t).overlaps(box)) found.push_back(t);
  return found;
}

bool PieceFinder::hides_any(const std::vector<std::uint32_t>& triangles, const Vec3& x,
                            const Vec3& node) const {
  return std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    return hides_segment(x * grid_.cell, node * grid_.cell, obstacles_.corners(t), obstacles_.indices(t));
  });
}

/// Among the corners of the cell of x and `ring` cells around it that none of the triangles hides.
NodeRef PieceFinder::nearest_inside(const Vec3& x, int ring, const std::vector<std::uint32_t>& hiding) const {
  const Int3 cell{static_cast<int>(std::floor(x.x())), static_cast<int>(std::floor(x.y())),
                  static_cast<int>(std::floor(x.z()))};
  NodeRef best;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = -ring; k <= ring + 1; ++k)
    for (int j = -ring; j <= ring + 1; ++j)
      for (int i = -ring; i <= ring + 1; ++i) {
        const Int3 at = cell + Int3{i, j, k};
        const double distance = (Vec3(at.x, at.y, at.z) - x).squaredNorm();
        if (distance >= nearest) continue;
        const NodeRef node = grid_.node_at(at);
        if (!grid_.is_inside(node) || hides_any(hiding, x, Vec3(at.x, at.y, at.z))) continue;
        nearest = distance;
        best = node;
      }
  return best;
}

std::uint32_t PieceFinder::find(const Vec3& x) const {
  const std::vector<std::uint32_t> around = triangles_around(x);
  NodeRef node = nearest_inside(x, 0, around);
  if (node.block == none) node = nearest_inside(x, 1, around);
  if (node.block == none && !around.empty()) node = nearest_inside(x, 1, {});
  return node.block == none ? none : piece_of_node_.find(key_of_node(node));
}

bool is_near_water(const Grid& grid, const Vec3& x) {
  if (!(x.cwiseAbs().maxCoeff() < 0x1p21)) return false;
  const auto low = [](double v) { return static_cast<int>(std::floor(v)) - 1; };
  const Int3 first{low(x.x()), low(x.y()), low(x.z())};
  for (int c = 0; c < 64; ++c) {
    if (grid.is_inside(grid.node_at(first + Int3{c & 3, c >> 2 & 3, c >> 4}))) return true;
  }
  return false;
}

Vec3 place_in_film(const Film& film, std::uint32_t p, const Vec3& x) {
  const FilmParticle* const item = film.find(p);
  if (!item || !(item->radius > 0)) return x;
  const double middle = FilmLayer(*item, 0).middle(double(item->grid_height), film.rule().clearance);
  return x + (middle - double(item->height)) * vec(item->normal);
}

std::vector<std::uint8_t> far_from_water(const ParticleBlocks& particles, const Film& film,
                                         const DrawnIn& drawn_in, const Grid& grid, const Workers& workers) {
  std::vector<std::uint8_t> result(particles.size(), 1);
  workers.for_each(particles.blocks.size(), 64, [&](std::size_t b) {
    const std::uint32_t block = grid.index.find(key_of(particles.blocks[b]));
    if (block != none && grid.blocks[block].solid) {
      std::fill(result.begin() + particles.begin[b], result.begin() + particles.begin[b + 1],
                std::uint8_t{0});
      return;
    }
    for (std::size_t p = particles.begin[b]; p < particles.begin[b + 1]; ++p) {
      // A coordinate may be 8 by rounding.
      const int i = std::min(int(particles.x[p]), side - 1), j = std::min(int(particles.y[p]), side - 1),
                k = std::min(int(particles.z[p]), side - 1);
      for (int c = 0; block != none && c < 8 && result[p]; ++c)
        result[p] = !grid.is_inside(corner_node(grid, block, i, j, k, c));
      if (!result[p]) continue;
      const Vec3 x = particles.place(b, p), in_film = place_in_film(film, static_cast<std::uint32_t>(p), x);
      result[p] =
          !is_near_water(grid, x + drawn_in.move(p)) && (in_film == x || !is_near_water(grid, in_film));
    }
  });
  return result;
}

}  // namespace oilskin::reconstruction
