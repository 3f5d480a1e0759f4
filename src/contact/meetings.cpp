#include "contact/meetings.h"

#include <algorithm>
#include <cmath>

#include "contact/records.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

double length_scale(const Quad& q) {
  return std::max({(q.a - q.p).norm(), (q.b - q.p).norm(), (q.c - q.p).norm()});
}

double landing_gap(const SurfaceMotion& s, double start_distance, int round) {
  OILSKIN_ASSERT(start_distance >= 0 && round >= 0);
  const double h = s.thickness;
  double gap = start_distance >= h ? h : start_distance + 0.1 * (h - start_distance);
  gap = std::ldexp(gap, -round);
  return std::max(gap, 2 * s.delta);
}

}  // namespace

StrikeGeometry strike_geometry(const Quad& x0, const Quad& x1, double time, double delta) {
  OILSKIN_ASSERT(time >= 0 && time <= 1 && delta > 0);
  StrikeGeometry g;
  const ClosestPoint start = closest_point(x0.p, x0.a, x0.b, x0.c);
  g.start_distance = start.distance;
  const double least = std::max(0.01 * delta, 1e-10 * length_scale(x0));

  // Inside the face the normal of the triangle at impact is the direction, on the side where the particle was
  // just before; the closest point of a slanting path would tilt it.
  const Quad at = interpolate(x0, x1, time);
  const ClosestPoint hit = closest_point(at.p, at.a, at.b, at.c);
  const bool inside = hit.feature == 7 && *std::min_element(hit.weights.begin(), hit.weights.end()) > 1e-3;
  for (double fraction : {0.95, 0.75, 0.5, 0.25}) {
    const Quad before = interpolate(x0, x1, fraction * time);
    if (inside) {
      const Vec3 n = geometric_normal(at.a, at.b, at.c);
      Vec3 foot = hit.weights[0] * before.a + hit.weights[1] * before.b + hit.weights[2] * before.c;
      const double side = n.dot(before.p - foot);
      if (std::abs(side) > least) {
        g.weights = hit.weights;
        g.normal = side > 0 ? n : Vec3(-n);
        return g;
      }
      continue;
    }
    const ClosestPoint c = closest_point(before.p, before.a, before.b, before.c);
    if (c.distance > least) {
      g.weights = c.weights;
      g.normal = c.offset / c.distance;
      return g;
    }
  }
  g.weights = start.weights;
  g.normal = start.distance > 0 ? Vec3(start.offset / start.distance) : geometric_normal(x0.a, x0.b, x0.c);
  return g;
}

std::vector<Row> rows_of_bad_pairs(Context& context, const std::vector<BadPair>& bad, int round) {
  std::vector<Row> rows;
  rows.reserve(bad.size());
  std::vector<std::uint32_t> landed;
  for (const BadPair& b : bad) {
    const SurfaceMotion& s = *context.surfaces[b.surface];
    const Quad x0 = context.start(b.particle, b.surface, b.triangle);
    const Quad x1 = context.end(b.particle, b.surface, b.triangle);
    const StrikeGeometry g = strike_geometry(x0, x1, b.time, s.delta);
    ContactRecord r;
    r.particle = b.particle;
    r.surface = b.surface;
    r.triangle = b.triangle;
    r.nodes = s.triangles[b.triangle];
    r.weights = g.weights;
    r.normal = g.normal;
    r.distance = g.start_distance;
    const Quad at = interpolate(x0, x1, b.time);
    r.back = g.normal.dot((at.b - at.a).cross(at.c - at.a)) < 0;
    Row row = row_of_record(context, r);
    row.stops = row.slips = true;
    OILSKIN_ASSERT(std::abs(g.normal.squaredNorm() - 1) < 1e-9);
    row.target_gap = landing_gap(s, g.start_distance, round);
    OILSKIN_ASSERT(row.target_gap >= 2 * s.delta);
    rows.push_back(row);
    if (b.meets) landed.push_back(static_cast<std::uint32_t>(rows.size() - 1));
  }
  // Bad pairs come in order of time, so the first of a particle is its earliest meeting.
  std::vector<std::uint8_t> done(context.particle_count(), 0);
  for (std::uint32_t k : landed) {
    const ContactRecord& r = rows[k].contact;
    if (done[r.particle] || context.particles->inverse_mass[r.particle] == 0) continue;
    done[r.particle] = 1;
    const SurfaceMotion& s = *context.surfaces[r.surface];
    Vec3 foot = Vec3::Zero();
    for (int k3 = 0; k3 < 3; ++k3) foot += r.weights[k3] * s.x_t1[r.nodes[k3]];
    context.set_particle_end(r.particle, foot + rows[k].target_gap * r.normal);
  }
  return rows;
}

}  // namespace oilskin::contact
