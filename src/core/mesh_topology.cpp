#include "core/mesh_topology.h"

#include <algorithm>
#include <numeric>

namespace oilskin {

namespace {

std::vector<std::uint32_t> find_first_equal(Span<const Triangle> triangles) {
  std::vector<Triangle> sorted(triangles.begin(), triangles.end());
  for (Triangle& t : sorted) std::sort(t.begin(), t.end());
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return sorted[i] < sorted[j]; });
  std::vector<std::uint32_t> first(triangles.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && sorted[order[k]] == sorted[order[k - 1]] ? first[order[k - 1]] : order[k];
  return first;
}

}  // namespace

MeshTopology::MeshTopology(Span<const Triangle> triangles, std::size_t node_count)
    : first_equal_(find_first_equal(triangles)), begin_(node_count + 1, 0) {
  collect_triangles_of_nodes(triangles);
  connect(triangles);
  find_parts();
}

void MeshTopology::collect_triangles_of_nodes(Span<const Triangle> triangles) {
  for (const Triangle& t : triangles)
    for (std::uint32_t node : t) {
      OILSKIN_ASSERT(node < node_count());
      ++begin_[node + 1];
    }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  triangle_.resize(begin_.back());
  OILSKIN_ASSERT(begin_.back() == 3 * triangles.size());
  std::vector<std::uint32_t> fill(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (std::uint32_t node : triangles[i]) triangle_[fill[node]++] = i;
}

void MeshTopology::connect(Span<const Triangle> triangles) {
  struct Edge {
    std::pair<std::uint32_t, std::uint32_t> nodes;
    std::uint32_t triangle, corner;
  };
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3 && !is_duplicate(t); ++k)
      edges.push_back({std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]), t, k});
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& a, const Edge& b) { return a.nodes < b.nodes; });
  std::vector<std::uint8_t> is_border_node(node_count(), 0);
  neighbour_.assign(triangles.size(), {none, none, none});
  turned_.assign(triangles.size(), 0);
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t stop = k;
    while (stop < edges.size() && edges[stop].nodes == edges[k].nodes) ++stop;
    const Edge &a = edges[k], &b = edges[std::min(k + 1, edges.size() - 1)];
    if (stop - k == 2)
      join(a.triangle, a.corner, b.triangle, b.corner,
           triangles[a.triangle][a.corner] == triangles[b.triangle][b.corner]);
    else
      is_border_node[a.nodes.first] = is_border_node[a.nodes.second] = 1;
    k = stop;
  }
  at_border_.reserve(triangles.size());
  for (const Triangle& t : triangles)
    at_border_.push_back(is_border_node[t[0]] | is_border_node[t[1]] | is_border_node[t[2]]);
}

void MeshTopology::join(std::uint32_t a, std::size_t edge_a, std::uint32_t b, std::size_t edge_b,
                        bool same_direction) {
  neighbour_[a][edge_a] = b;
  neighbour_[b][edge_b] = a;
  if (!same_direction) return;
  turned_[a] = static_cast<std::uint8_t>(turned_[a] | 1u << edge_a);
  turned_[b] = static_cast<std::uint8_t>(turned_[b] | 1u << edge_b);
}

bool MeshTopology::is_closed_at(std::uint32_t triangle) const {
  const std::array<std::uint32_t, 3>& n = neighbour_[triangle];
  return turned_[triangle] == 0 && std::find(n.begin(), n.end(), none) == n.end();
}

void MeshTopology::find_parts() {
  part_.assign(neighbour_.size(), none);
  is_closed_.assign(neighbour_.size(), 1);
  std::vector<std::uint32_t> open;
  for (std::uint32_t first = 0; first < part_.size(); ++first) {
    if (part_[first] != none) continue;
    open.assign(1, first);
    part_[first] = first;
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      if (!is_closed_at(t)) is_closed_[first] = 0;
      for (const std::uint32_t n : neighbour_[t]) {
        if (n == none || part_[n] != none) continue;
        part_[n] = first;
        open.push_back(n);
      }
    }
  }
}

}  // namespace oilskin
