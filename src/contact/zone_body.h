/// An impact zone that moves with a rigid body (docs/theory/contact.md, "Zones").
#pragma once

#include "contact/zone_velocity.h"

namespace oilskin::contact {

/// The motion of a body within the interval, x → c¹ + R (x − c⁰).
struct BodyPath {
  Vec3 center_t0, center_t1;
  Eigen::Matrix3d rotation;

  Vec3 end_of(const Vec3& start) const { return center_t1 + rotation * (start - center_t0); }
};

/// R is the rotation that takes the nodes from x_t0 to x_t0 + displacement[i] with the least squares of
/// errors [Kabsch1976]. `displacement` has as many as there are nodes.
BodyPath path_of_body(const SurfaceMotion& surface, const Vec3* displacement);

/// The common motion of a body and of the free points that move with it: perfectly inelastic, v + ω × r with
/// the body's ω and (C.41). Momentum is kept; the body takes the moment of what the points gain.
class RidingVelocity {
 public:
  explicit RidingVelocity(const BodyMotion& body) : body_(body) { common_.add(body); }
  void add(double inverse_mass, const Vec3& start, const Vec3& velocity) {
    common_.add(inverse_mass, velocity - spin(start));
  }
  /// Of a point that starts at `start`.
  Vec3 at(const Vec3& start) const { return value() + spin(start); }
  /// v: along axes that the host locks, that of the body.
  Vec3 value() const { return (body_.inverse_mass.array() > 0).select(common_.value(), body_.velocity); }

 private:
  Vec3 spin(const Vec3& start) const { return body_.angular_velocity.cross(start - body_.center_t0); }

  const BodyMotion body_;
  ZoneVelocity common_;
};

}  // namespace oilskin::contact
