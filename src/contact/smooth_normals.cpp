#include "contact/smooth_normals.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

/// Triangles that meet at more than 60° have an edge between them. The same holds between the interpolated
/// normal and the contact's own: beside a border the sheet has no normal towards the particle.
constexpr double smooth_cosine = 0.5;

/// Angle and unit normal of a triangle at its corner `u`; false without area.
bool corner_of(const Triangle& nodes, Span<const Vec3> x, std::uint32_t u, double& angle, Vec3& normal) {
  const auto at = static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), u) - nodes.begin());
  const Vec3 a = x[nodes[(at + 1) % 3]] - x[u], b = x[nodes[(at + 2) % 3]] - x[u];
  const Vec3 area = a.cross(b);
  const double size = area.norm();
  if (!(size > 1e-7 * std::max(a.squaredNorm(), b.squaredNorm()))) return false;
  angle = std::atan2(size, a.dot(b));
  normal = area / size;
  return true;
}

/// Angle-weighted [Baerentzen2005] over the triangles at the node that meet that of normal `own` smoothly.
Vec3 normal_at(const MeshTopology& topology, const SurfaceMotion& s, std::uint32_t node, const Vec3& own) {
  Vec3 sum = Vec3::Zero(), normal;
  double angle = 0;
  for (std::uint32_t t : topology.triangles_of(node)) {
    if (topology.is_duplicate(t) || !corner_of(s.triangles[t], s.x_t0, node, angle, normal)) continue;
    if (normal.dot(own) > smooth_cosine) sum += angle * normal;
  }
  return sum.squaredNorm() > 0 ? sum.normalized() : own;
}

Vec3 start_velocity(const Context& context, const Contact& c) {
  const SurfaceMotion& s = *context.surfaces[c.surface];
  const std::vector<Vec3>& of_nodes = s.velocity_t0.size() == s.velocity.size() ? s.velocity_t0 : s.velocity;
  Vec3 v = context.start_velocity.empty() ? context.particles->velocity[c.particle]
                                          : context.start_velocity[c.particle];
  for (int k = 0; k < 3; ++k) v -= c.weights[k] * of_nodes[c.nodes[k]];
  return v;
}

}  // namespace

void smooth_normal(const Context& context, ContactConstraint& constraint) {
  const Contact& c = constraint.contact;
  const SurfaceMotion& s = *context.surfaces[c.surface];
  if (!s.smooth_normals || context.settings->repulsion != Repulsion::split) return;
  Vec3 own;
  double angle = 0;
  if (!corner_of(c.nodes, s.x_t0, c.nodes[0], angle, own)) return;
  Vec3 sum = Vec3::Zero();
  double cosine = 1;
  for (int k = 0; k < 3; ++k) {
    const Vec3 n = normal_at(context.geometry[c.surface]->topology, s, c.nodes[k], own);
    sum += c.weights[k] * n;
    cosine = std::min(cosine, n.dot(own));
  }
  const Vec3 normal = (c.back ? -sum : sum).normalized();
  if (!(normal.dot(c.normal) >= smooth_cosine)) return;
  constraint.normal = normal;
  // (C.36): two neighbours deviate from their common corner's normal by that angle each.
  constraint.max_turn = std::tan(2 * std::acos(std::min(cosine, 1.0)));
  constraint.turn = std::max(0.0, -start_velocity(context, c).dot(normal));
}

}  // namespace oilskin::contact
