#include "fluid/boundary/near_triangles.h"

#include <cmath>
#include <numeric>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t triangle_chunk = 64;

/// `is_asked(i)`: for which particles?
template <class IsAsked>
void collect(const BoundaryInput& input, std::uint32_t surface, std::uint32_t triangle, double plane_reach,
             const IsAsked& is_asked, std::vector<NearTriangle>& found) {
  const SurfaceMotion& motion = *input.surfaces[surface];
  const Triangle& node = motion.triangles[triangle];
  const Vec3 &a = motion.x_t0[node[0]], &b = motion.x_t0[node[1]], &c = motion.x_t0[node[2]];
  Box box;
  for (const Vec3& corner : {a, b, c}) box.add(corner);
  box = box.inflated(input.support_radius);
  const Vec3 cross = (b - a).cross(c - a);
  const double inverse_norm = cross.norm() > 0 ? 1 / cross.norm() : 0;
  const Vec3 middle = (a + b + c) / 3;
  const double size2 =
      std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()});
  const double reach = (1 + 1e-9) * (std::sqrt(size2) + input.support_radius), reach2 = reach * reach;
  input.neighbours.for_runs_in(box, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (!is_asked(i) || !box.contains(input.x[i])) continue;
      const double z = cross.dot(input.x[i] - a) * inverse_norm;
      if (std::abs(z) >= plane_reach || (input.x[i] - middle).squaredNorm() > reach2) continue;
      const ClosestPoint closest = closest_point(input.x[i], a, b, c);
      if (closest.distance < input.support_radius) found.push_back({i, surface, triangle, closest});
    }
  });
}

}  // namespace

// The loop runs over triangles, as most particles are near none.
void NearTriangles::find(const BoundaryInput& input, double plane_reach,
                         const std::vector<std::uint8_t>& marks, const Workers& workers) {
  OILSKIN_ASSERT(input.topologies.size() == input.surfaces.size());
  const auto is_asked = [&](std::uint32_t i) { return marks.empty() || marks[i] != 0; };
  std::size_t first = 0;
  for (std::uint32_t s = 0; s < input.surfaces.size(); ++s) {
    const MeshTopology& topology = *input.topologies[s];
    const TriangleChoice triangles(input.near, s, topology.triangle_count());
    OILSKIN_ASSERT(topology.triangle_count() == input.surfaces[s]->triangles.size());
    const std::size_t end = first + (triangles.size() + triangle_chunk - 1) / triangle_chunk;
    if (found_.size() < end) found_.resize(end);
    workers.for_chunks(triangles.size(), triangle_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
      std::vector<NearTriangle>& found = found_[first + c];
      found.clear();
      for (std::size_t k = b; k < e; ++k) {
        const std::uint32_t t = triangles[k];
        if (!topology.is_duplicate(t)) collect(input, s, t, plane_reach, is_asked, found);
      }
    });
    first = end;
  }
  sort_by_particle(input.x.size(), first);
}

/// Counting sort by particle, stable.
void NearTriangles::sort_by_particle(std::size_t particles, std::size_t chunks) {
  begin_.assign(particles + 1, 0);
  for (std::size_t c = 0; c < chunks; ++c)
    for (const NearTriangle& n : found_[c]) ++begin_[n.particle + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  if (list_.size() < begin_.back()) list_.resize(begin_.back() + begin_.back() / 4);
  next_.assign(begin_.begin(), begin_.end() - 1);
  for (std::size_t c = 0; c < chunks; ++c)
    for (const NearTriangle& n : found_[c]) list_[next_[n.particle]++] = n;
}

}  // namespace oilskin::fluid
