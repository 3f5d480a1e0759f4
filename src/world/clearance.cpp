#include "world/clearance.h"

#include "contact/predicates.h"
#include "core/assert.h"

namespace oilskin::world {

namespace {

Box bounds_of(const StandingSurface& surface) {
  if (surface.still != 0) {
    surface.geometry->fit(surface.triangles, surface.x, surface.x, surface.still);
    return surface.geometry->tree.bounds();
  }
  Box bounds;
  for (const Vec3& x : surface.x) bounds.add(x);
  return bounds;
}

void block_near(const StandingSurface& surface, Span<const Vec3> points, const Workers& workers,
                std::vector<std::uint8_t>& blocked) {
  OILSKIN_ASSERT(surface.delta > 0 && !surface.triangles.empty() && surface.geometry);
  const double cutoff = 2 * surface.delta;
  const Box bounds = bounds_of(surface).inflated(cutoff);
  std::vector<Box> boxes;
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (blocked[i] || !bounds.contains(points[i])) continue;
    boxes.push_back(Box{points[i], points[i]}.inflated(cutoff));
    index.push_back(i);
  }
  if (boxes.empty()) return;
  surface.geometry->fit(surface.triangles, surface.x, surface.x, surface.still);
  proximity::Candidates candidates;
  surface.geometry->tree.query(boxes, workers, candidates);
  OILSKIN_ASSERT(candidates.begin.size() == boxes.size() + 1);
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (std::uint32_t t : candidates.of(k)) {
      const Triangle& nodes = surface.triangles[t];
      const contact::PointTriangle q{points[index[k]], surface.x[nodes[0]], surface.x[nodes[1]],
                                     surface.x[nodes[2]]};
      if (contact::end_distance(q, cutoff).too_close) blocked[index[k]] = 1;
    }
}

}  // namespace

std::vector<std::uint8_t> find_blocked_points(Span<const StandingSurface> surfaces, Span<const Vec3> points,
                                              const Workers& workers) {
  std::vector<std::uint8_t> blocked(points.size(), 0);
  if (points.empty()) return blocked;
  for (const StandingSurface& s : surfaces) block_near(s, points, workers, blocked);
  return blocked;
}

}  // namespace oilskin::world
