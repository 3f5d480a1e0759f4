/// An impact zone that moves with a rigid body (docs/theory/contact.md, "Zones").
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::contact {

/// The common motion v + ω × r of a body and of what moves with it, free points and other bodies: perfectly
/// inelastic (C.41). Momentum and angular momentum about the body's centre are kept, and the kinetic energy
/// cannot rise.
class RidingVelocity {
 public:
  explicit RidingVelocity(const BodyMotion& body) : body_(body) {}
  /// A free point that starts at `start`.
  void add(double inverse_mass, const Vec3& start, const Vec3& velocity);
  /// Another body, which no axis is locked of.
  void add(const BodyMotion& other);
  void solve();
  // After solve()
  Vec3 at(const Vec3& start) const { return velocity_ + angular_velocity_.cross(start - body_.center_t0); }
  const Vec3& velocity() const { return velocity_; }                  ///< of the body's centre
  const Vec3& angular_velocity() const { return angular_velocity_; }  ///< [rad/s]

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  using Matrix36 = Eigen::Matrix<double, 3, 6>;

  /// The velocity of the point at `arm` per velocity and angular velocity of all.
  static Matrix36 velocity_at_arm(const Vec3& arm);

  const BodyMotion body_;
  // Of what moves with the body, about the body's centre: momentum (3) and angular momentum (3)
  Matrix6 mass_ = Matrix6::Zero();      // per velocity (3) and angular velocity (3) of all
  Vector6 momentum_ = Vector6::Zero();  // beyond what they have where they move with the body
  Vec3 velocity_ = Vec3::Zero(), angular_velocity_ = Vec3::Zero();
};

}  // namespace oilskin::contact
