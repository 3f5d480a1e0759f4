#include "contact/turn.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

/// Triangles at more than 60° to each other have an edge between them.
constexpr double smooth_cosine = 0.5;

/// Unit, or zero for a triangle without area.
Vec3 unit_normal(const Triangle& nodes, Span<const Vec3> x) {
  const Vec3 a = x[nodes[1]] - x[nodes[0]], b = x[nodes[2]] - x[nodes[0]], area = a.cross(b);
  const double size = area.norm();
  return size > 1e-7 * std::max(a.squaredNorm(), b.squaredNorm()) ? Vec3(area / size) : Vec3::Zero();
}

/// The tangent of the largest angle at which a triangle that has a node with this one continues it.
double max_turn(const MeshTopology& topology, const SurfaceMotion& s, std::uint32_t triangle) {
  const Triangle& nodes = s.triangles[triangle];
  const Vec3 own = unit_normal(nodes, s.x_t0);
  double cosine = 1;
  for (std::uint32_t node : nodes)
    for (std::uint32_t t : topology.triangles_of(node)) {
      const double c = unit_normal(s.triangles[t], s.x_t0).dot(own);
      if (c > smooth_cosine) cosine = std::min(cosine, c);
    }
  return std::sqrt(1 - cosine * cosine) / cosine;
}

/// Relative velocity at the start of the interval, before its forces.
Vec3 start_velocity(const Context& context, const Contact& c) {
  const SurfaceMotion& s = *context.surfaces[c.surface];
  const std::vector<Vec3>& of_nodes = s.velocity_t0.size() == s.velocity.size() ? s.velocity_t0 : s.velocity;
  Vec3 v = context.start_velocity.empty() ? context.particles->velocity[c.particle]
                                          : context.start_velocity[c.particle];
  for (int k = 0; k < 3; ++k) v -= c.weights[k] * of_nodes[c.nodes[k]];
  return v;
}

}  // namespace

void find_turn(const Context& context, ContactConstraint& constraint) {
  const Contact& c = constraint.contact;
  const SurfaceMotion& s = *context.surfaces[c.surface];
  if (!s.smooth) return;
  constraint.turn = std::max(0.0, -start_velocity(context, c).dot(c.normal));
  if (constraint.turn > 0)
    constraint.max_turn = max_turn(context.geometry[c.surface]->topology, s, c.triangle);
}

double speed_to_turn(const ContactConstraint& constraint, double normal_speed, double tangential_speed) {
  OILSKIN_ASSERT(constraint.turn >= 0 && constraint.max_turn >= 0 && tangential_speed >= 0);
  return std::max(0.0, std::min({-normal_speed, constraint.turn, constraint.max_turn * tangential_speed}));
}

}  // namespace oilskin::contact
