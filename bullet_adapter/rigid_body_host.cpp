#include "rigid_body_host.h"

#include <algorithm>

#include "convert.h"
#include "core/body_motion.h"
#include "core/body_path.h"

namespace oilskin::bullet {

namespace {

/// Bullet multiplies the change of the angular velocity with the factor; with the moment multiplied too, what
/// is left of the inertia is symmetric, and no impulse makes energy.
Eigen::Matrix3d inverse_inertia(const btRigidBody& body) {
  Eigen::Matrix3d inverse;
  for (int row = 0; row < 3; ++row) inverse.row(row) = to_vec3(body.getInvInertiaTensorWorld().getRow(row));
  const Vec3 factor = to_vec3(body.getAngularFactor());
  return factor.asDiagonal() * (0.5 * (inverse + inverse.transpose())) * factor.asDiagonal();
}

BodyMotion motion_of(const btRigidBody& body) {
  BodyMotion motion;
  motion.inverse_mass = static_cast<double>(body.getInvMass()) * to_vec3(body.getLinearFactor());
  motion.inverse_inertia = inverse_inertia(body);
  motion.center_t1 = to_vec3(body.getCenterOfMassPosition());
  motion.velocity = to_vec3(body.getLinearVelocity());
  motion.angular_velocity = to_vec3(body.getAngularVelocity());
  motion.gravity = to_vec3(body.getGravity());
  return motion;
}

}  // namespace

bool RigidBodyHost::is_dynamic() const {
  return !body_->isStaticOrKinematicObject() && body_->getInvMass() > 0 &&
         body_->getActivationState() != DISABLE_SIMULATION;
}

Gathered RigidBodyHost::gather(double dt, SurfaceMotion& motion) {
  const double speed_before = motion.body ? motion.body->velocity.norm() : 0;
  const bool is_teleport = dt == 0 || state().forget_motion;
  Gathered gathered = CollisionObjectHost::gather(dt, motion);
  motion.body.reset();
  if (!gathered.status.ok()) return gathered;
  start_ = is_teleport || gathered.new_surface ? body_->getWorldTransform() : end_;
  end_ = body_->getWorldTransform();
  unexplained_ = 0;
  if (!is_dynamic()) return gathered;
  gathered.unchanged = false;
  motion.revision = 0;
  motion.body = motion_of(*body_);
  motion.body->center_t0 = motion.body->center_t1;
  for (std::size_t i = 0; i < motion.velocity.size(); ++i)
    motion.velocity[i] = velocity_at(*motion.body, motion.x_t1[i] - motion.body->center_t1);
  motion.holdable.assign(motion.x_t1.size(), 1);
  proposed_ = motion.x_t1;
  // Between two sub-steps of Bullet a collision may have changed the velocity.
  const double fastest =
      std::max(speed_before, motion.body->velocity.norm()) + dt * motion.body->gravity.norm();
  const double moved = static_cast<double>((end_.getOrigin() - start_.getOrigin()).length());
  unexplained_ = std::max(0.0, moved - 2 * dt * fastest);
  return gathered;
}

void RigidBodyHost::scatter(SurfaceMotion& motion) {
  if (!motion.body) return CollisionObjectHost::scatter(motion);
  const BodyMotion& body = *motion.body;
  if (!body.impulse.isZero(0) || !body.angular_impulse.isZero(0)) {
    body_->activate();
    body_->applyCentralImpulse(to_bt(body.impulse));
    body_->applyTorqueImpulse(to_bt(to_vec3(body_->getAngularFactor()).cwiseProduct(body.angular_impulse)));
  }
  if (motion.x_t1 != proposed_) follow_nodes(motion);
  end_ = body_->getWorldTransform();
}

/// The certified nodes remain where they are: the transform follows them to rounding.
void RigidBodyHost::follow_nodes(const SurfaceMotion& motion) {
  // World::reset_motion() lets the nodes start where they are proposed.
  btTransform end = motion.x_t0 == proposed_ ? end_ : start_;
  if (motion.x_t1 != motion.x_t0) {
    const BodyPath path = path_of_body(motion);
    end.setOrigin(to_bt(path.end_of(to_vec3(end.getOrigin()))));
    btMatrix3x3 rotation;
    for (int row = 0; row < 3; ++row) rotation[row] = to_bt(path.rotation.row(row).transpose());
    btQuaternion turned;
    (rotation * end.getBasis()).getRotation(turned);
    end.setRotation(turned.normalized());
  }
  body_->setCenterOfMassTransform(end);
  body_->setInterpolationWorldTransform(end);
  forget_positions();
}

}  // namespace oilskin::bullet
