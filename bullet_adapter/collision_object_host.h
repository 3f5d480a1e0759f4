/// A static or kinematic btCollisionObject as a surface.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "oilskin/surface_motion.h"
#include "shape_mesh.h"

namespace oilskin::bullet {

/// All nodes are prescribed and not holdable: the owner moves the object, and it receives no impulse.
/// Positions are world positions in btScalar, transformed as Bullet does.
class CollisionObjectHost : public SurfaceHost {
 public:
  /// Static planes are clipped to `kill_box` [m].
  CollisionObjectHost(const btCollisionObject* object, const Box& kill_box);

  /// Reads transform and scaling again. Refuses shapes without triangles, planes outside the kill box and
  /// transforms that are not finite.
  Gathered gather(double dt, SurfaceMotion& motion) override;
  /// Does not change the object; sets x_t1 to its positions.
  void scatter(SurfaceMotion& motion) override;

  /// Whether that changes the polygon of a plane.
  bool set_kill_box(const Box& kill_box);
  /// How far the triangles of round shapes may be from them [m]; 0 = as near as they get (read_shape()). A
  /// larger one than the present one is ignored: water that lies on a shape would be inside a coarser one.
  void set_tolerance(double tolerance);

  /// The motion up to the next gather is a teleport, and the shape is read again.
  void forget_motion() { forget_motion_ = true; }

  /// What the host remembers from step to step.
  struct State {
    bool forget_motion = true;
    btTransform start = btTransform::getIdentity();  ///< of a rigid body, as the last step left it
  };
  virtual State state() const { return {forget_motion_, btTransform::getIdentity()}; }
  virtual void set_state(const State& state) { forget_motion_ = state.forget_motion; }

 protected:
  /// The next gather computes them again.
  void forget_positions() { world_.clear(); }

 private:
  Status read_if_changed();
  Status update_positions(const btTransform& transform);

  const btCollisionObject* object_;
  Box kill_box_;
  double tolerance_ = 0;
  bool forget_motion_ = true;
  std::vector<double> signature_;
  ShapeMesh mesh_;
  btTransform transform_;       // of world_
  std::uint64_t revision_ = 0;  // of world_ and triangles_
  std::vector<Vec3> world_;
  std::vector<Triangle> triangles_;
};

}  // namespace oilskin::bullet
