#include "contact/features.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::contact {

std::uint64_t feature_key(const MeshTopology& topology, std::uint32_t triangle, const Triangle& nodes,
                          std::uint8_t feature) {
  // Two bits of kind, then the nodes (31 bits each) or the face.
  OILSKIN_ASSERT(triangle < topology.triangle_count() && feature >= 1 && feature <= 7);
  constexpr std::uint64_t edge_kind = 1ull << 62, face_kind = 2ull << 62;
  std::uint32_t on[3] = {};
  int count = 0;
  for (int k = 0; k < 3; ++k)
    if (feature & (1 << k)) on[count++] = nodes[k];
  if (count == 3) return face_kind | topology.first_equal(triangle);
  if (count == 2 && on[0] != on[1]) {
    const std::uint64_t low = std::min(on[0], on[1]), high = std::max(on[0], on[1]);
    return edge_kind | low << 31 | high;
  }
  return on[0];
}

bool is_local_minimum(const MeshTopology& topology, Span<const Triangle> triangles, Span<const Vec3> x,
                      std::uint32_t triangle, const ClosestPoint& c) {
  if (c.feature == 7) return true;
  OILSKIN_ASSERT(triangles.size() == topology.triangle_count() && triangle < triangles.size());
  OILSKIN_ASSERT(x.size() == topology.node_count());
  const Triangle& nodes = triangles[triangle];
  const int first = c.feature & 1 ? 0 : (c.feature & 2 ? 1 : 2);
  const bool is_edge = (c.feature & (c.feature - 1)) != 0;
  const int second = !is_edge ? first : (c.feature & 4 ? 2 : 1);
  std::uint32_t u = nodes[first], v = nodes[second];
  // Of the two nodes of an edge the one with fewer triangles: there may be thousands.
  if (topology.triangles_of(v).size() < topology.triangles_of(u).size()) std::swap(u, v);
  const Vec3 along = x[v] - x[u];
  const double along2 = along.squaredNorm();
  // Going from the closest point into a triangle that has this feature, by a direction d at a right angle to
  // it, shortens the distance when offset·d > 0. The tolerance keeps both contacts where rounding decides.
  for (std::uint32_t t : topology.triangles_of(u)) {
    // The triangle's own closest point is known. Testing it again would reject both long sides of a sliver,
    // whose face has no closest point.
    if (topology.first_equal(t) == topology.first_equal(triangle)) continue;
    bool has_v = false;
    for (std::uint32_t w : triangles[t]) has_v |= w == v;
    if (!has_v) continue;
    for (std::uint32_t w : triangles[t]) {
      if (w == u || w == v) continue;
      Vec3 d = x[w] - x[u];
      if (is_edge && along2 > 0) d -= along * (along.dot(d) / along2);
      if (c.offset.dot(d) > 1e-9 * c.distance * d.norm()) return false;
    }
  }
  return true;
}

}  // namespace oilskin::contact
