#include "world/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/predicates.h"
#include "core/assert.h"
#include "core/row_crossing.h"

namespace oilskin::world {

namespace {

Box bounds_of(const StandingSurface& surface, const Workers& workers) {
  if (surface.still != 0) {
    surface.geometry->fit(surface.triangles, surface.x, surface.x, surface.still, workers);
    return surface.geometry->tree.bounds();
  }
  Box bounds;
  for (const Vec3& x : surface.x) bounds.add(x);
  return bounds;
}

/// f(i, nodes of a triangle, point i and the triangle) for the points i with skipped[i] = 0 and triangles
/// that may be nearer than `reach` [m].
template <class F>
void for_near_triangles(const StandingSurface& surface, double reach, Span<const Vec3> points,
                        const std::vector<std::uint8_t>& skipped, const Workers& workers, const F& f) {
  OILSKIN_ASSERT(surface.delta > 0 && !surface.triangles.empty() && surface.geometry);
  const Box bounds = bounds_of(surface, workers).inflated(reach);
  std::vector<Box> boxes;
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (skipped[i] || !bounds.contains(points[i])) continue;
    boxes.push_back(Box{points[i], points[i]}.inflated(reach));
    index.push_back(i);
  }
  if (boxes.empty()) return;
  surface.geometry->fit(surface.triangles, surface.x, surface.x, surface.still, workers);
  proximity::Candidates candidates;
  surface.geometry->tree.query(boxes, workers, candidates);
  OILSKIN_ASSERT(candidates.begin.size() == boxes.size() + 1);
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (std::uint32_t t : candidates.of(k)) {
      const Triangle& nodes = surface.triangles[t];
      f(index[k], nodes,
        contact::PointTriangle{points[index[k]], surface.x[nodes[0]], surface.x[nodes[1]],
                               surface.x[nodes[2]]});
    }
}

/// Blocks the points inside a closed surface.
void block_enclosed_points(const StandingSurface& surface, Span<const Vec3> points, const Workers& workers,
                           std::vector<std::uint8_t>& blocked) {
  const Box bounds = bounds_of(surface, workers);
  workers.for_each(points.size(), 1024, [&](std::size_t i) {
    if (!blocked[i] && bounds.contains(points[i]) &&
        crossing_number(surface.triangles, surface.x, points[i]) != 0)
      blocked[i] = 1;
  });
}

/// The triangle of a surface that is nearest to a point.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  bool is_behind = false;  ///< the point is on its back
  bool yields = false;     ///< a node of it is free
};

}  // namespace

std::vector<std::uint8_t> find_blocked_points(Span<const StandingSurface> surfaces, Span<const Vec3> points,
                                              const Workers& workers) {
  std::vector<std::uint8_t> blocked(points.size(), 0);
  if (points.empty()) return blocked;
  for (const StandingSurface& s : surfaces) {
    const double cutoff = 2 * s.delta;
    for_near_triangles(s, cutoff, points, blocked, workers,
                       [&](std::uint32_t i, const Triangle&, const contact::PointTriangle& q) {
                         if (contact::end_distance(q, cutoff).too_close) blocked[i] = 1;
                       });
    if (s.solid) block_enclosed_points(s, points, workers, blocked);
  }
  return blocked;
}

void block_crowded_points(Span<const StandingSurface> surfaces, double distance, double spacing,
                          Span<const Vec3> points, const Workers& workers,
                          std::vector<std::uint8_t>& blocked) {
  for (const StandingSurface& s : surfaces) {
    std::vector<Nearest> nearest(points.size());
    for_near_triangles(s, spacing, points, blocked, workers,
                       [&](std::uint32_t i, const Triangle& nodes, const contact::PointTriangle& q) {
                         const ClosestPoint c = closest_point(q.p, q.a, q.b, q.c);
                         if (c.distance >= std::min(spacing, nearest[i].distance)) return;
                         nearest[i].distance = c.distance;
                         nearest[i].is_behind = c.offset.dot((q.b - q.a).cross(q.c - q.a)) < 0;
                         nearest[i].yields = std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t n) {
                           return s.inverse_mass[n] > 0;
                         });
                       });
    bool has_points[2] = {false, false};  // in front, behind
    for (const Nearest& n : nearest) has_points[n.is_behind] |= std::isfinite(n.distance);
    const bool is_between = has_points[0] && has_points[1];
    for (std::size_t i = 0; i < points.size(); ++i)
      if (nearest[i].distance < distance && (is_between || !nearest[i].yields)) blocked[i] = 1;
  }
}

}  // namespace oilskin::world
