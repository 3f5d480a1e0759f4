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
  input.neighbours.for_runs_in(box, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (!is_asked(i) || !box.contains(input.x[i])) continue;
      const double z = cross.dot(input.x[i] - a) * inverse_norm;
      if (std::abs(z) >= plane_reach) continue;
      const ClosestPoint closest = closest_point(input.x[i], a, b, c);
      if (closest.distance < input.support_radius) found.push_back({i, surface, triangle, closest});
    }
  });
}

/// Counting sort by particle, stable.
NearTriangles sort_by_particle(std::size_t particles, const std::vector<std::vector<NearTriangle>>& found) {
  NearTriangles near;
  near.begin.assign(particles + 1, 0);
  for (const auto& part : found)
    for (const NearTriangle& n : part) ++near.begin[n.particle + 1];
  std::partial_sum(near.begin.begin(), near.begin.end(), near.begin.begin());
  near.list.resize(near.begin.back());
  std::vector<std::uint32_t> at(near.begin.begin(), near.begin.end() - 1);
  for (const auto& part : found)
    for (const NearTriangle& n : part) near.list[at[n.particle]++] = n;
  return near;
}

}  // namespace

// The loop runs over triangles, as most particles are near none.
NearTriangles find_near_triangles(const BoundaryInput& input, double plane_reach,
                                  const std::vector<std::uint8_t>& marks, const Workers& workers) {
  OILSKIN_ASSERT(input.topologies.size() == input.surfaces.size());
  std::vector<std::vector<NearTriangle>> found;
  for (std::uint32_t s = 0; s < input.surfaces.size(); ++s) {
    const MeshTopology& topology = *input.topologies[s];
    const std::size_t triangles = input.surfaces[s]->triangles.size(), first = found.size();
    OILSKIN_ASSERT(topology.triangle_count() == triangles);
    found.resize(first + (triangles + triangle_chunk - 1) / triangle_chunk);
    workers.for_chunks(triangles, triangle_chunk, [&](std::size_t b, std::size_t e, std::size_t chunk) {
      for (auto t = static_cast<std::uint32_t>(b); t < e; ++t)
        if (!topology.is_duplicate(t))
          collect(
              input, s, t, plane_reach, [&](std::uint32_t i) { return marks.empty() || marks[i] != 0; },
              found[first + chunk]);
    });
  }
  return sort_by_particle(input.x.size(), found);
}

}  // namespace oilskin::fluid
