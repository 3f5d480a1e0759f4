/// @file
/// What a game hears of the water: touches, splashes and finished steps.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btVector3.h>

#include "oilskin/bullet_sensor.h"
#include "oilskin/report.h"

namespace oilskin::bullet {

class btFluidCoupling;

/// What the water did to an object in one coupled step.
struct btFluidTouch {
  /// The sum of the impulses of the water on the object, by contact and pressure [N s].
  btVector3 m_impulse = btVector3(0, 0, 0);
  /// Their moment about the origin [N m s].
  btVector3 m_angularImpulse = btVector3(0, 0, 0);
  /// The mean of the places where the impulses act, weighted by their sizes [m]. Impulses act at nodes: an
  /// impulse within a triangle counts at its corners, by its barycentric weights, which have the same mean.
  btVector3 m_place = btVector3(0, 0, 0);
  /// The number of particles with a contact at the object, each dx² [m²]; of the last fluid sub-step.
  btScalar m_area = 0;
  /// The length of the step [s].
  btScalar m_timeStep = 0;
};

/// Is called after each coupled step, on the thread that steps: after the last of Bullet's work in the
/// sub-step with btFluidSoftBodySolver, at the end of btFluidCoupling::step() without. Each sub-step has its
/// own calls, so that none is lost.
///
/// *Order.* By object, in the order in which they were attached: touchBegan, splash, touchEnded, of
/// sensors waterEntered, waterLeft; then stepped. Every call goes to all listeners, in the order in which
/// they were added, before the next call. The order and all numbers are the same for any number of threads.
///
/// *What a listener may do.* Everything but to step (btFluidCoupling::step() and stepSimulation() within a
/// call couple nothing, and leave a message) and to delete the coupling, its solver or Bullet's world. It may
/// attach, remove and delete objects, fluids and listeners, itself included. Calls that are due for an
/// object that was removed are left out. Exceptions leave the step, which is done; the rest of its calls is
/// lost.
class btFluidListener {
 public:
  btFluidListener() = default;
  /// Removes itself from its coupling.
  virtual ~btFluidListener();
  btFluidListener(const btFluidListener&) = delete;
  btFluidListener& operator=(const btFluidListener&) = delete;

  /// The water gave the object an impulse for the first time since it was attached or the last touch ended.
  virtual void touchBegan(const btCollisionObject* /*object*/, const btFluidTouch& /*touch*/) {}
  /// The water has not given the object any impulse for btFluidCoupling::getTouchHold() seconds. Is not
  /// called for objects that were removed.
  virtual void touchEnded(const btCollisionObject* /*object*/) {}
  /// In this step the impulse was above getSplashThreshold(). Water of weight W at rest gives W dt in each
  /// step: choose a threshold above it.
  virtual void splash(const btCollisionObject* /*object*/, const btFluidTouch& /*touch*/) {}
  /// Water entered a sensor in this step: `flow` is that of the step.
  virtual void waterEntered(const btCollisionObject* /*sensor*/, const btFluidFlow& /*flow*/) {}
  /// Water left a sensor in this step.
  virtual void waterLeft(const btCollisionObject* /*sensor*/, const btFluidFlow& /*flow*/) {}
  /// The world made a step, or refused it: then `report.status` says why. The report is a copy.
  virtual void stepped(const StepReport& /*report*/) {}

  /// [N s], ≥ 0. Refuses negative numbers and NaN. Default: infinite, no splash.
  Status setSplashThreshold(btScalar impulse);
  /// [N s].
  btScalar getSplashThreshold() const { return m_splashThreshold; }

 private:
  friend class btFluidCoupling;
  btFluidCoupling* m_coupling = nullptr;
  btScalar m_splashThreshold = std::numeric_limits<btScalar>::infinity();
};

}  // namespace oilskin::bullet
