#include "contact/squeeze.h"

#include <algorithm>

#include "contact/surface_point.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

Vec3 end_of(const SurfaceMotion& s, const Contact& c) {
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < 3; ++k) x += c.weights[k] * s.x_t1[c.nodes[k]];
  return x;
}

double step_of(const SurfaceMotion& s, double dt) {
  return s.body && s.body->host_step > 0 ? s.body->host_step : dt;
}

/// What gravity adds to the velocity of a body before it moves on; sheets have theirs in hand.
Vec3 gravity_of(const SurfaceMotion& s, double dt) {
  return s.body ? Vec3(step_of(s, dt) * along_free_axes(*s.body, s.body->gravity)) : Vec3::Zero();
}

}  // namespace

Squeezes::Squeezes(const Context& context, const std::vector<ContactConstraint>& constraints) {
  if (std::none_of(context.surfaces.begin(), context.surfaces.end(),
                   [](auto* s) { return s->body.has_value(); }))
    return;
  for (std::size_t begin = 0, end = 0; begin < constraints.size(); begin = end) {
    const std::uint32_t particle = constraints[begin].contact.particle;
    while (end < constraints.size() && constraints[end].contact.particle == particle) ++end;
    for (std::size_t a = begin; a < end; ++a)
      for (std::size_t b = a + 1; b < end; ++b)
        if (constraints[a].normal_active && constraints[b].normal_active)
          add(context, constraints[a].contact, constraints[b].contact);
  }
}

void Squeezes::add(const Context& context, const Contact& a, const Contact& b) {
  const SurfaceMotion &above = *context.surfaces[a.surface], &below = *context.surfaces[b.surface];
  if (!above.body && !below.body) return;
  if (a.surface == b.surface || !are_opposing(a, b)) return;
  Squeeze s;
  s.above = a;
  s.below = b;
  s.normal = (b.normal - a.normal).normalized();
  s.k = inverse_mass_along(above, a, s.normal) + inverse_mass_along(below, b, s.normal);
  if (!(s.k > 0)) return;
  const double gap = s.normal.dot(end_of(above, a) - end_of(below, b));
  const double thickness = std::max(above.thickness, below.thickness);
  const double step = std::max(step_of(above, context.dt), step_of(below, context.dt));
  s.allowed = std::max(0.0, gap - thickness) / step;
  s.next = gravity_of(above, context.dt) - gravity_of(below, context.dt);
  squeezes_.push_back(s);
}

void Squeezes::solve(Context& context) {
  for (Squeeze& s : squeezes_) {
    SurfaceMotion &above = *context.surfaces[s.above.surface], &below = *context.surfaces[s.below.surface];
    const Vec3 velocity = velocity_of(above, s.above) - velocity_of(below, s.below) + s.next;
    const double impulse = std::max(0.0, s.impulse - (velocity.dot(s.normal) + s.allowed) / s.k);
    const Vec3 change = (impulse - s.impulse) * s.normal;
    if (change.isZero(0)) continue;
    OILSKIN_ASSERT(change.allFinite());
    s.impulse = impulse;
    push_point(above, s.above, change);
    push_point(below, s.below, -change);
  }
}

}  // namespace oilskin::contact
