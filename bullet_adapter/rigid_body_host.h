/// A btRigidBody, dynamic or not, as a surface.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "collision_object_host.h"

namespace oilskin::bullet {

/// While the body is dynamic it receives the impulses of the water: Bullet's sub-step has moved it already,
/// so they act from the next one on. Contact may hold it for an interval, or let it move with a heavier body,
/// where a particle has no other way out. Linear and angular factors are respected. While it is static or
/// kinematic, it is a CollisionObjectHost.
class RigidBodyHost : public CollisionObjectHost {
 public:
  /// Static planes are clipped to `kill_box` [m].
  RigidBodyHost(btRigidBody* body, const Box& kill_box) : CollisionObjectHost(body, kill_box), body_(body) {}

  Gathered gather(double dt, SurfaceMotion& motion) override;
  /// Wakes the body where it received an impulse.
  void scatter(SurfaceMotion& motion) override;

  /// How far the last step moved the body beyond what its velocity explains [m]; 0 after
  /// forget_motion(), and unless the body is dynamic.
  double unexplained() const { return unexplained_; }

  State state() const override { return {CollisionObjectHost::state().forget_motion, end_}; }
  void set_state(const State& state) override {
    CollisionObjectHost::set_state(state);
    end_ = state.start;
  }

 private:
  bool is_dynamic() const;
  void follow_nodes(const SurfaceMotion& motion);

  btRigidBody* body_;
  btTransform start_ = btTransform::getIdentity();  // of the nodes at x_t0
  btTransform end_ = btTransform::getIdentity();    // of those at x_t1: as proposed, then as the step left it
  std::vector<Vec3> proposed_;                      // x_t1 as gather() filled it in
  double unexplained_ = 0;                          // [m]
};

}  // namespace oilskin::bullet
