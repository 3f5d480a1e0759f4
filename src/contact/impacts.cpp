#include "contact/impacts.h"

#include <algorithm>
#include <cmath>

#include "contact/contacts.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

double length_scale(const PointTriangle& q) {
  return std::max({(q.a - q.p).norm(), (q.b - q.p).norm(), (q.c - q.p).norm()});
}

double landing_gap(const SurfaceMotion& s, double start_distance, int iteration) {
  OILSKIN_ASSERT(start_distance >= 0 && iteration >= 0);
  const double h = s.thickness;
  double gap = start_distance >= h ? h : start_distance + 0.1 * (h - start_distance);
  gap = std::ldexp(gap, -iteration);
  return std::max(gap, 2 * s.delta);
}

}  // namespace

ImpactGeometry impact_geometry(const PointTriangle& x0, const PointTriangle& x1, double time, double delta) {
  OILSKIN_ASSERT(time >= 0 && time <= 1 && delta > 0);
  ImpactGeometry g;
  const ClosestPoint start = closest_point(x0.p, x0.a, x0.b, x0.c);
  g.start_distance = start.distance;
  const double min_distance = std::max(0.01 * delta, 1e-10 * length_scale(x0));

  // Inside the face: the triangle's normal at impact, on the side of the particle just before. The direction
  // to the closest point would be tilted by an oblique path.
  const PointTriangle at = interpolate(x0, x1, time);
  const ClosestPoint hit = closest_point(at.p, at.a, at.b, at.c);
  const bool inside = hit.feature == 7 && *std::min_element(hit.weights.begin(), hit.weights.end()) > 1e-3;
  for (double fraction : {0.95, 0.75, 0.5, 0.25}) {
    const PointTriangle before = interpolate(x0, x1, fraction * time);
    if (inside) {
      const Vec3 n = geometric_normal(at.a, at.b, at.c);
      Vec3 foot = hit.weights[0] * before.a + hit.weights[1] * before.b + hit.weights[2] * before.c;
      const double side = n.dot(before.p - foot);
      if (std::abs(side) > min_distance) {
        g.weights = hit.weights;
        g.normal = side > 0 ? n : Vec3(-n);
        return g;
      }
      continue;
    }
    const ClosestPoint c = closest_point(before.p, before.a, before.b, before.c);
    if (c.distance > min_distance) {
      g.weights = c.weights;
      g.normal = c.offset / c.distance;
      return g;
    }
  }
  g.weights = start.weights;
  g.normal = start.distance > 0 ? Vec3(start.offset / start.distance) : geometric_normal(x0.a, x0.b, x0.c);
  return g;
}

namespace {

ContactConstraint impact_constraint(const Context& context, const Violation& v, int iteration) {
  const SurfaceMotion& s = *context.surfaces[v.surface];
  const PointTriangle x0 = context.start(v.particle, v.surface, v.triangle);
  const PointTriangle x1 = context.end(v.particle, v.surface, v.triangle);
  const ImpactGeometry g = impact_geometry(x0, x1, v.time, s.delta);
  Contact contact;
  contact.particle = v.particle;
  contact.surface = v.surface;
  contact.triangle = v.triangle;
  contact.nodes = s.triangles[v.triangle];
  contact.weights = g.weights;
  contact.normal = g.normal;
  contact.distance = g.start_distance;
  const PointTriangle at = interpolate(x0, x1, v.time);
  contact.back = g.normal.dot((at.b - at.a).cross(at.c - at.a)) < 0;
  ContactConstraint constraint = make_constraint(context, contact);
  constraint.normal_active = constraint.friction_active = true;
  OILSKIN_ASSERT(std::abs(g.normal.squaredNorm() - 1) < 1e-9);
  constraint.target_gap = landing_gap(s, g.start_distance, iteration);
  OILSKIN_ASSERT(constraint.target_gap >= 2 * s.delta);
  return constraint;
}

}  // namespace

std::vector<ContactConstraint> impact_constraints(Context& context, const std::vector<Violation>& violations,
                                                  int iteration) {
  std::vector<ContactConstraint> constraints;
  constraints.reserve(violations.size());
  std::vector<std::uint32_t> impacts;  // constraints of intersecting paths
  for (const Violation& v : violations) {
    constraints.push_back(impact_constraint(context, v, iteration));
    if (v.paths_intersect) impacts.push_back(static_cast<std::uint32_t>(constraints.size() - 1));
  }
  // Violations come in order of time, so the first of a particle is its earliest impact.
  std::vector<std::uint8_t> done(context.particle_count(), 0);
  for (std::uint32_t k : impacts) {
    const Contact& c = constraints[k].contact;
    if (done[c.particle] || context.particles->inverse_mass[c.particle] == 0) continue;
    done[c.particle] = 1;
    const SurfaceMotion& s = *context.surfaces[c.surface];
    Vec3 foot = Vec3::Zero();
    for (int corner = 0; corner < 3; ++corner) foot += c.weights[corner] * s.x_t1[c.nodes[corner]];
    context.set_particle_end(c.particle, foot + constraints[k].target_gap * c.normal);
  }
  return constraints;
}

}  // namespace oilskin::contact
