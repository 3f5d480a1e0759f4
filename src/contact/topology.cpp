#include "contact/topology.h"

#include <algorithm>
#include <numeric>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

std::vector<std::uint32_t> first_of_equal_triangles(Span<const Triangle> triangles) {
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

Topology::Topology(Span<const Triangle> triangles, std::size_t nodes)
    : canonical_(first_of_equal_triangles(triangles)), begin_(nodes + 1, 0) {
  for (const Triangle& t : triangles)
    for (std::uint32_t v : t) {
      OILSKIN_ASSERT(v < nodes);
      ++begin_[v + 1];
    }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  triangle_.resize(begin_.back());
  OILSKIN_ASSERT(begin_.back() == 3 * triangles.size());
  std::vector<std::uint32_t> fill(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (std::uint32_t v : triangles[i]) triangle_[fill[v]++] = i;
}

std::uint64_t Topology::feature_key(std::uint32_t triangle, const Triangle& nodes,
                                    std::uint8_t feature) const {
  // Two bits of kind, then the nodes (31 bits each are plenty) or the face.
  OILSKIN_ASSERT(triangle < canonical_.size() && feature >= 1 && feature <= 7);
  constexpr std::uint64_t edge_kind = 1ull << 62, face_kind = 2ull << 62;
  std::uint32_t on[3] = {};
  int count = 0;
  for (int k = 0; k < 3; ++k)
    if (feature & (1 << k)) on[count++] = nodes[k];
  if (count == 3) return face_kind | canonical_[triangle];
  if (count == 2 && on[0] != on[1]) {
    const std::uint64_t low = std::min(on[0], on[1]), high = std::max(on[0], on[1]);
    return edge_kind | low << 31 | high;
  }
  return on[0];
}

bool Topology::is_local_minimum(Span<const Triangle> triangles, Span<const Vec3> x, std::uint32_t triangle,
                                const ClosestPoint& c) const {
  if (c.feature == 7) return true;
  OILSKIN_ASSERT(triangles.size() == canonical_.size() && triangle < triangles.size());
  OILSKIN_ASSERT(x.size() + 1 == begin_.size());
  const Triangle& nodes = triangles[triangle];
  const int first = c.feature & 1 ? 0 : (c.feature & 2 ? 1 : 2);
  const bool is_edge = (c.feature & (c.feature - 1)) != 0;
  const int second = !is_edge ? first : (c.feature & 4 ? 2 : 1);
  std::uint32_t u = nodes[first], v = nodes[second];
  if (triangles_of(v).size() < triangles_of(u).size()) std::swap(u, v);  // at a hub thousands
  const Vec3 along = x[v] - x[u];
  const double along2 = along.squaredNorm();
  // Going from the closest point into a triangle that has this feature, by a direction d at a right angle to
  // it, shortens the distance when offset·d > 0. The tolerance keeps both records where rounding decides.
  for (std::uint32_t t : triangles_of(u)) {
    // The triangle itself has said what is nearest of it. Asked again, a sliver whose face has no closest
    // point would send both of its long sides away.
    if (canonical_[t] == canonical_[triangle]) continue;
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
