#include "reconstruction/blobs.h"

#include "core/assert.h"
#include "core/disjoint_sets.h"

namespace oilskin::reconstruction {

namespace {

/// Numbers the nodes of blocks with values; a solid block has one number.
class NodeNumbers {
 public:
  explicit NodeNumbers(const Grid& grid) : grid_(grid), solid_(grid.inside_bits.size() * nodes) {}
  std::size_t count() const { return solid_ + grid_.blocks.size(); }
  std::uint32_t of(const NodeRef& n) const {
    const std::uint32_t field = grid_.blocks[n.block].field;
    return static_cast<std::uint32_t>(field != none ? std::size_t(field) * nodes + std::size_t(n.node)
                                                    : solid_ + n.block);
  }

 private:
  const Grid& grid_;
  std::size_t solid_;
};

void join_nodes(const Grid& grid, std::uint32_t b, const NodeNumbers& number, DisjointSets& sets) {
  BlockRows rows;
  rows.gather(grid, b);
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j) {
      const std::size_t r = std::size_t(j + 9 * k);
      const unsigned in = rows.inside[r];
      const unsigned next[3] = {in >> 1, rows.inside[r + 1], rows.inside[r + 9]};
      for (int axis = 0; axis < 3; ++axis) {
        const unsigned cut = rows.has_cuts ? rows.cut[std::size_t(axis)][r] : 0;
        for (unsigned both = in & next[axis] & ~cut & 0xff; both != 0; both &= both - 1) {
          const int i = __builtin_ctz(both);
          sets.unite(number.of({b, node_index(i, j, k)}),
                     number.of(grid.node(b, i + (axis == 0), j + (axis == 1), k + (axis == 2))));
        }
      }
    }
}

}  // namespace

double six_volumes(const std::vector<std::array<float, 3>>& positions, const Triangle& t,
                   const std::array<float, 3>& origin) {
  const auto at = [&](std::uint32_t v) {
    const auto& p = positions[v];
    return Vec3(double(p[0]) - origin[0], double(p[1]) - origin[1], double(p[2]) - origin[2]);
  };
  return at(t[0]).dot(at(t[1]).cross(at(t[2])));
}

namespace {

/// Keeps the triangles whose vertices have a new number.
void keep_triangles(const std::vector<std::uint32_t>& renumbered, RawMesh& mesh) {
  std::uint32_t kept = 0;
  for (std::size_t b = 0; b + 1 < mesh.first_triangle.size(); ++b) {
    const std::uint32_t begin = mesh.first_triangle[b], end = mesh.first_triangle[b + 1];
    mesh.first_triangle[b] = kept;
    for (std::uint32_t n = begin; n < end; ++n) {
      const Triangle t = mesh.triangles[n];
      if (renumbered[t[0]] == none) continue;
      OILSKIN_ASSERT(renumbered[t[1]] != none && renumbered[t[2]] != none);
      mesh.triangles[kept] = {renumbered[t[0]], renumbered[t[1]], renumbered[t[2]]};
      mesh.triangle_cubes[kept++] = mesh.triangle_cubes[n];
    }
  }
  mesh.first_triangle.back() = kept;
  mesh.triangles.resize(kept);
  mesh.triangle_cubes.resize(kept);
}

}  // namespace

void remove_vertices(const std::vector<std::uint8_t>& removed, RawMesh& mesh) {
  const std::size_t n = mesh.positions.size();
  OILSKIN_ASSERT(removed.size() == n && mesh.inside_nodes.size() == n && mesh.distances.size() == n);
  std::vector<std::uint32_t> renumbered(n, none);
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < n; ++v) {
    if (removed[v]) continue;
    renumbered[v] = kept;
    mesh.positions[kept] = mesh.positions[v];
    mesh.distances[kept] = mesh.distances[v];
    mesh.inside_nodes[kept++] = mesh.inside_nodes[v];
  }
  for (std::uint32_t& first : mesh.first_vertex) {
    // The first kept vertex at or after it.
    while (first < n && renumbered[first] == none) ++first;
    first = first < n ? renumbered[first] : kept;
  }
  mesh.positions.resize(kept);
  mesh.inside_nodes.resize(kept);
  mesh.distances.resize(kept);
  keep_triangles(renumbered, mesh);
}

std::size_t remove_blobs(const Grid& grid, double min_volume, const std::vector<double>& water_near,
                         RawMesh& mesh) {
  OILSKIN_ASSERT(mesh.inside_nodes.size() == mesh.positions.size());
  if (mesh.positions.empty()) return 0;
  const NodeNumbers number(grid);
  DisjointSets sets(number.count());
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) join_nodes(grid, b, number, sets);

  std::vector<double> volume(number.count(), 0);
  std::vector<std::uint32_t> piece(mesh.positions.size());
  for (std::size_t v = 0; v < piece.size(); ++v) piece[v] = sets.find(number.of(mesh.inside_nodes[v]));
  for (const Triangle& t : mesh.triangles)
    volume[piece[t[0]]] += six_volumes(mesh.positions, t, mesh.positions[0]) / 6;

  for (std::size_t v = 0; v < water_near.size(); ++v)
    volume[piece[v]] = std::max(volume[piece[v]], water_near[v]);

  std::vector<std::uint8_t> counted(number.count(), 0), is_small(piece.size(), 0);
  std::size_t removed = 0;
  for (std::size_t v = 0; v < piece.size(); ++v) {
    if (!(volume[piece[v]] < min_volume)) continue;
    is_small[v] = 1;
    removed += !counted[piece[v]];
    counted[piece[v]] = 1;
  }
  if (removed > 0) remove_vertices(is_small, mesh);
  return removed;
}

}  // namespace oilskin::reconstruction
