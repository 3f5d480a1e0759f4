#include "fluid/boundary/surface_mesh.h"

#include <algorithm>

namespace oilskin::fluid {

namespace {

std::vector<std::uint8_t> repeated_triangles(const SurfaceMotion& s) {
  std::vector<std::pair<Triangle, std::uint32_t>> sorted;
  for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
    Triangle nodes = s.triangles[t];
    std::sort(nodes.begin(), nodes.end());
    sorted.push_back({nodes, t});
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint8_t> repeated(s.triangles.size(), 0);
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (sorted[k].first == sorted[k - 1].first) repeated[sorted[k].second] = 1;
  return repeated;
}

std::vector<std::uint8_t> triangles_at_border(const SurfaceMotion& s,
                                              const std::vector<std::uint8_t>& repeated) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3 && !repeated[t]; ++k)
      edges.push_back(std::minmax(s.triangles[t][k], s.triangles[t][(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> node_at_border(s.x_t0.size(), 0), at_border;
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t stop = k;
    while (stop < edges.size() && edges[stop] == edges[k]) ++stop;
    if (stop - k != 2) node_at_border[edges[k].first] = node_at_border[edges[k].second] = 1;
    k = stop;
  }
  for (const Triangle& t : s.triangles)
    at_border.push_back(node_at_border[t[0]] | node_at_border[t[1]] | node_at_border[t[2]]);
  return at_border;
}

}  // namespace

SurfaceMesh::SurfaceMesh(const SurfaceMotion& surface)
    : repeated_(repeated_triangles(surface)), at_border_(triangles_at_border(surface, repeated_)) {}

}  // namespace oilskin::fluid
