#include "object_state.h"

#include "bullet_archive.h"

namespace oilskin::bullet {

void ObjectState::capture(const btCollisionObject& object) {
  transform = object.getWorldTransform();
  interpolation = object.getInterpolationWorldTransform();
  interpolation_velocity = object.getInterpolationLinearVelocity();
  interpolation_angular_velocity = object.getInterpolationAngularVelocity();
  activation = object.getActivationState();
  deactivation_time = object.getDeactivationTime();
}

void ObjectState::visit(Archive& archive) {
  bullet::visit(archive, transform);
  bullet::visit(archive, interpolation);
  bullet::visit(archive, interpolation_velocity);
  bullet::visit(archive, interpolation_angular_velocity);
  archive.value(activation);
  bullet::visit(archive, deactivation_time);
  archive.require(activation >= ACTIVE_TAG && activation <= FIXED_BASE_MULTI_BODY, "an activation state");
}

void ObjectState::apply(btCollisionObject& object) const {
  object.setWorldTransform(transform);
  object.setInterpolationWorldTransform(interpolation);
  object.setInterpolationLinearVelocity(interpolation_velocity);
  object.setInterpolationAngularVelocity(interpolation_angular_velocity);
  object.forceActivationState(activation);
  object.setDeactivationTime(deactivation_time);
}

void RigidState::capture(const btRigidBody& body) {
  velocity = body.getLinearVelocity();
  angular_velocity = body.getAngularVelocity();
  force = body.getTotalForce();
  torque = body.getTotalTorque();
  inverse_mass = body.getInvMass();
  inverse_inertia = body.getInvInertiaDiagLocal();
  motion_state.reset();
  if (body.getMotionState()) body.getMotionState()->getWorldTransform(motion_state.emplace());
}

void RigidState::visit(Archive& archive) {
  for (btVector3* v : {&velocity, &angular_velocity, &force, &torque, &inverse_inertia})
    bullet::visit(archive, *v);
  bullet::visit(archive, inverse_mass);
  archive.optional(motion_state, [&](btTransform& transform) { bullet::visit(archive, transform); });
}

Status RigidState::check(const btRigidBody& body) const {
  const bool same = body.getInvMass() == inverse_mass && body.getInvInertiaDiagLocal() == inverse_inertia;
  return same ? Status::accepted()
              : Status::refused("has another mass or inertia than the saved one: set that first");
}

/// Bullet adds forces times the factors of the axes; those of the state have been multiplied already.
void RigidState::apply(btRigidBody& body) const {
  body.setLinearVelocity(velocity);
  body.setAngularVelocity(angular_velocity);
  body.updateInertiaTensor();
  const btVector3 linear = body.getLinearFactor(), angular = body.getAngularFactor(), one(1, 1, 1);
  body.setLinearFactor(one);
  body.setAngularFactor(one);
  body.clearForces();
  body.applyCentralForce(force);
  body.applyTorque(torque);
  body.setLinearFactor(linear);
  body.setAngularFactor(angular);
  if (motion_state && body.getMotionState()) body.getMotionState()->setWorldTransform(*motion_state);
}

}  // namespace oilskin::bullet
