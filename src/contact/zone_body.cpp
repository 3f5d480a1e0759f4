#include "contact/zone_body.h"

#include <Eigen/LU>

#include "core/assert.h"
#include "core/body_motion.h"

namespace oilskin::contact {

RidingVelocity::Matrix36 RidingVelocity::velocity_at_arm(const Vec3& arm) {
  Matrix36 m;
  m << Eigen::Matrix3d::Identity(), -cross_matrix(arm);
  return m;
}

void RidingVelocity::add(double inverse_mass, const Vec3& start, const Vec3& velocity) {
  const double mass = 1 / inverse_mass;
  const Vec3 arm = start - body_.center_t0;
  const Matrix36 at_arm = velocity_at_arm(arm);
  mass_ += mass * at_arm.transpose() * at_arm;
  momentum_ += mass * at_arm.transpose() * (velocity - velocity_at(body_, arm));
}

void RidingVelocity::add(const BodyMotion& other) {
  OILSKIN_ASSERT(is_free(other));
  const Vec3 mass = other.inverse_mass.cwiseInverse(), arm = other.center_t0 - body_.center_t0;
  const Matrix36 at_arm = velocity_at_arm(arm);
  const Eigen::Matrix3d inertia = inertia_of(other);
  mass_ += at_arm.transpose() * mass.asDiagonal() * at_arm;
  mass_.bottomRightCorner<3, 3>() += inertia;
  momentum_ += at_arm.transpose() * mass.cwiseProduct(other.velocity - velocity_at(body_, arm));
  momentum_.tail<3>() += inertia * (other.angular_velocity - body_.angular_velocity);
}

/// The impulse P that the body takes: P = momentum − mass A P, where A P is the change of its motion. Unlike
/// the sum of the masses this form has a solution where the host locks axes.
void RidingVelocity::solve() {
  Matrix6 inverse_mass = Matrix6::Zero();
  inverse_mass.topLeftCorner<3, 3>() = body_.inverse_mass.asDiagonal();
  inverse_mass.bottomRightCorner<3, 3>() = body_.inverse_inertia;
  const Matrix6 system = Matrix6::Identity() + mass_ * inverse_mass;
  const Vector6 change = inverse_mass * system.fullPivLu().solve(momentum_);
  velocity_ = body_.velocity + change.head<3>();
  angular_velocity_ = body_.angular_velocity + change.tail<3>();
}

}  // namespace oilskin::contact
