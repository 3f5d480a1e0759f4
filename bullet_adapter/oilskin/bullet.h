/// @file
/// Water for Bullet's soft bodies. As in Bullet, the user creates and owns all objects, and Oilskin keeps raw
/// pointers. It couples in updateSoftBodies(), the last call of each of Bullet's sub-steps, or in an explicit
/// step(dt). It never changes rest lengths, masses, tick callbacks, user pointers or tags.
#pragma once

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <string>
#include <vector>

#include "oilskin/bullet_fluid.h"

// Single and double precision Bullet share header and symbol names. A program compiled for one and linked
// with the adapter of the other would corrupt memory. It does not link, and the missing symbol names the
// reason.
#ifdef BT_USE_DOUBLE_PRECISION
#define OILSKIN_BULLET_GUARD oilskin_this_file_sees_double_precision_Bullet_link_oilskin_bullet_f64
static_assert(sizeof(btScalar) == sizeof(double),
              "BT_USE_DOUBLE_PRECISION must be defined before Bullet's headers");
#else
#define OILSKIN_BULLET_GUARD oilskin_this_file_sees_single_precision_Bullet_link_oilskin_bullet
static_assert(sizeof(btScalar) == sizeof(float),
              "link oilskin::bullet_f64, which defines BT_USE_DOUBLE_PRECISION");
#endif
extern "C" const char OILSKIN_BULLET_GUARD;
#if defined(__GNUC__)
namespace oilskin::bullet::detail {
__attribute__((used)) static const char* const link_guard = &OILSKIN_BULLET_GUARD;
}
#elif defined(_MSC_VER) && defined(BT_USE_DOUBLE_PRECISION)
#pragma detect_mismatch("oilskin_bullet_precision", "double")
#elif defined(_MSC_VER)
#pragma detect_mismatch("oilskin_bullet_precision", "single")
#endif

/// The adapter for Bullet.
namespace oilskin::bullet {

class btFluidListener;
struct btFluidReading;

/// Couples fluids with soft bodies and collision objects. Add it to a world with addAction() for debug
/// drawing only: actions run before Bullet solves the cloth, so nothing is coupled there.
///
/// Attached objects must be removed from the coupling before they are deleted, except those that it can miss:
/// soft bodies with btFluidSoftBodySolver, if the next call of the coupling is that of Bullet's next
/// sub-step, and all objects with setCollisionWorld(). Bodies may be cut, refined and re-ordered while they
/// are attached: they become new surfaces. Attached objects carry a number in Bullet's internal extension
/// pointer, where that was null.
class btFluidCoupling : public btActionInterface {
 public:
  /// Adds the fluid, if there is one.
  explicit btFluidCoupling(btFluid* fluid = nullptr);
  ~btFluidCoupling() override;
  btFluidCoupling(const btFluidCoupling&) = delete;
  btFluidCoupling& operator=(const btFluidCoupling&) = delete;

  /// Adds a fluid; all objects are attached to it, those added before and later. With several fluids, such as
  /// water and oil, all touch the same objects in one step, and no particle of any crosses
  /// (World::step_together()): fluids act on each other through objects alone, and pass through each other
  /// where none is between them. Of the first fluid are the settings of contact. Refuses null, a fluid that
  /// is in a coupling, more than 255 fluids, and a fluid whose FluidSettings::boundary is not that of the
  /// first.
  Status addFluid(btFluid* fluid);
  /// Removes a fluid. With the last one the objects remain, and are attached to the next one.
  void removeFluid(btFluid* fluid);
  /// The first fluid; null = none.
  btFluid* getFluid() const;
  /// The i-th fluid; null for i outside 0 … getNumFluids() − 1.
  btFluid* getFluid(int i) const;
  /// The number of fluids.
  int getNumFluids() const;

  /// Refuses soft bodies without faces, thicknesses below 4 δ [m] or above twice the diagonal of the body,
  /// and bodies that are attached already, here or in another coupling; a refusal attaches nothing. Without a
  /// fluid δ is not known, and addFluid() may refuse later.
  Status addCloth(btSoftBody* cloth, btScalar thickness, const SlipSettings& slip = {});
  /// The same with all settings.
  ///
  /// mayHoldPins: pins that close on a particle from both sides are held for a step, and counted.
  ///
  /// weldNodes: nodes at bit-equal positions (an unwelded mesh) are one node with their common mass for
  /// contact. Every coupling moves them to their centre of mass with their common velocity, because Bullet
  /// lets them separate, and water would pass between them. Off for sheets that are to separate there.
  Status addCloth(btSoftBody* cloth, const SurfaceSettings& settings = {}, bool mayHoldPins = true,
                  bool weldNodes = true);
  /// Detaches a cloth. One that is not attached is ignored.
  void removeCloth(btSoftBody* cloth);
  /// Attaches a static or kinematic object; for dynamic rigid bodies there is addRigidBody(). Triangle meshes
  /// (all concave shapes that list their triangles), boxes and convex hulls are exact, without the margin
  /// that Bullet adds outside of hulls. Spheres are triangles with their volume, other convex shapes the hull
  /// of some of their points: 42 to 642 points, the fewest that are within 10 % of the finest fluid's
  /// spacing of the shape. Static planes are their part inside the kill box; compounds consist of these.
  /// Transform and scaling are read at every step.
  ///
  /// An object with btCollisionObject::CF_NO_CONTACT_RESPONSE, a dynamic one or btGhostObject included, is a
  /// sensor: no wall, but getReading() has the water that enters, leaves and is inside. Its shape must have a
  /// volume: convex, or a compound of convex shapes. The flag may change while it is attached, and acts from
  /// the next step on.
  Status addCollisionObject(btCollisionObject* object, btScalar thickness, const SlipSettings& slip = {});
  /// The same with all settings.
  Status addCollisionObject(btCollisionObject* object, const SurfaceSettings& settings = {});
  /// Detaches an object. One that is not attached is ignored.
  void removeCollisionObject(btCollisionObject* object);
  /// Attaches a rigid body, with the shapes of addCollisionObject(). While it is dynamic, the water moves it:
  /// impulses act on its linear and angular velocity, by its mass, its inertia and its linear and angular
  /// factors, from Bullet's next sub-step on, and wake it. It floats where it is lighter than water. Bullet
  /// alone decides where it goes, but where a particle is between it and something else without a way out,
  /// the body waits for a step (ContactReport::held). Refuses what addCollisionObject() refuses, and dynamic
  /// bodies that are in another coupling.
  Status addRigidBody(btRigidBody* body, btScalar thickness, const SlipSettings& slip = {});
  /// The same with all settings.
  Status addRigidBody(btRigidBody* body, const SurfaceSettings& settings = {});
  /// Detaches a body. One that is not attached is ignored.
  void removeRigidBody(btRigidBody* body);

  /// Detaches, before each step, attached objects that `world` does not have, with a message; it does not
  /// touch them, so they may be deleted after removeRigidBody() or removeSoftBody() alone. A new object at
  /// the address of a deleted one is not attached. The world must exist at each step. Null: no world
  /// (default).
  void setCollisionWorld(const btCollisionWorld* world);

  /// The messages since the last call: objects that were detached because their world no longer has them,
  /// settings that were overwritten, reasons of refused steps, and the messages of all steps' reports. Of
  /// messages about one surface that differ in numbers alone the last; at most 256.
  std::vector<std::string> takeMessages();

  /// The positions of the cloth at the next step are a teleport, not a motion.
  void resetMotion(btSoftBody* cloth);
  /// The transform of the object at the next step is a teleport, not a motion.
  void resetMotion(btCollisionObject* object);

  /// The gravity of the fluid: that of the first cloth's btSoftBodyWorldInfo while a cloth is attached
  /// (default), or that of WorldSettings and World::set_gravity().
  void setUseClothGravity(bool use);
  /// Whether the next step takes the gravity of a cloth.
  bool followsClothGravity() const;

  /// Whether loaded nodes of supported cloth weigh up to half a layer of the water on them, too, where
  /// the load would move them by more than 0.03 spacings in a step (default; C.29). Off: water on cloth that
  /// is much lighter falls on until its stored speed is p dt/σ, and may be flung away.
  void setCarriesWater(bool carries);
  /// Whether they do.
  bool getCarriesWater() const;

  /// One coupled step for engines that own their world; call it after stepSimulation(). dt [s] is the time
  /// that the cloth has moved since the last call: Bullet's sub-steps × their length. 0 (no sub-step) does
  /// nothing, and the motion is part of the next step.
  const StepReport& step(btScalar dt);
  /// The report of the last step, with the balance of energies: of all fluids together. World::report() of
  /// each has its own particles and pressure.
  const StepReport& getReport() const;

  /// The impulses on the nodes in the last step [N s], one per node in Bullet's order, at pins the reaction;
  /// null for a cloth that is not attached.
  const std::vector<Vec3>* getNodeImpulses(const btSoftBody* cloth) const;
  /// The motion of a cloth in the last step; null for one that is not attached. load_of() gives the force on
  /// it.
  const SurfaceMotion* getSurface(const btSoftBody* cloth) const;
  /// The motion of an object in the last step; null for one that is not attached. load_of() gives the force.
  const SurfaceMotion* getSurface(const btCollisionObject* object) const;
  /// The handle of a cloth in the first fluid's world, for World::node_values() and World::set_slip(); none
  /// for one that is not attached, or without a fluid. Nodes that are welded are one node there.
  SurfaceId getSurfaceId(const btSoftBody* cloth) const;
  /// The handle of an object in the first fluid's world.
  SurfaceId getSurfaceId(const btCollisionObject* object) const;
  /// The handle of an object, also a cloth, in the world of a fluid of the coupling; none for another fluid.
  SurfaceId getSurfaceId(const btCollisionObject* object, const btFluid* fluid) const;

  /// Calls the listener after each coupled step (oilskin/bullet_listener.h). It is the caller's, and removes
  /// itself when it is deleted. Refuses null, and a listener that is in a coupling already.
  Status addListener(btFluidListener* listener);
  /// One that is not there is ignored.
  void removeListener(btFluidListener* listener);
  /// A touch ends when the water has not given the object any impulse for this time [s], ≥ 0 (default 0.1 s).
  /// With 0 it ends in the first step without an impulse, and may begin and end many times at rest.
  Status setTouchHold(btScalar seconds);
  /// [s].
  btScalar getTouchHold() const;

  /// The reports of all steps since the last call as one: StepReport::add().
  StepReport takeReport();
  /// The impulses of the water on an object since the last call: their sum [N s] and their moment about the
  /// origin [N m s]. False, and nothing is written, for one that is not attached.
  bool takeImpulse(const btCollisionObject* object, btVector3& linear, btVector3& angular);
  /// What a sensor has measured up to the last step (oilskin/bullet_sensor.h); null for an object that is not
  /// attached or is a wall. The reading changes with each step.
  const btFluidReading* getReading(const btCollisionObject* object) const;
  /// The object with this handle in a fluid of the coupling, null = the first; null for one that is not
  /// attached.
  const btCollisionObject* getObject(SurfaceId surface, const btFluid* fluid = nullptr) const;
  /// The object of a Contact::surface of the last step of such a fluid; null where it was removed since.
  const btCollisionObject* getObject(std::uint32_t surface, const btFluid* fluid = nullptr) const;

  /// Writes the state that determines all further steps: that of the fluids (World::save()), of the emitters
  /// that were added with btFluid::addEmitter(), and of each attached object what Bullet's steps change; with
  /// readings of sensors, touches, impulses, reports and messages that were not taken yet. Call it between
  /// two calls of stepSimulation() that leave no remaining time. What the game sets is not written: settings
  /// of objects, gravity of Bullet's worlds, effects themselves (docs/manual/saving.md). Refuses null, calls
  /// by a listener, objects whose state is not finite, soft bodies with clusters or joints, and bodies of the
  /// deformable solver. A refusal leaves `out` as it is.
  ///
  /// With a world, the contact points, impulses, pairs and broadphase that it keeps from step to step are
  /// written, too: those of all its objects. Without them rigid bodies that touch each other go on slightly
  /// differently. Refuses worlds without btDbvtBroadphase and btCollisionDispatcher.
  Status saveState(std::vector<std::uint8_t>* out, btCollisionWorld* world = nullptr) const;
  /// Gives the fluids, the emitters and all attached objects the state that was saved, here or in another
  /// process: the same build and precision, with the same fluids, objects and emitters, added in the same
  /// order.
  /// Refuses, and changes nothing, where the bytes are damaged or of another version, or where objects,
  /// emitters, their number, their meshes or their masses are others. Spans, reports and contacts of the
  /// fluid's world are invalid after it.
  /// The world is to be given if it was given to saveState(), with the same objects in the same order; the
  /// states of those that are not attached are the caller's, to be set before.
  Status restoreState(Span<const std::uint8_t> saved, btCollisionWorld* world = nullptr);

  /// Moves everything by `offset` [m], for games far from the origin: the fluids with kill boxes, sinks and
  /// emitters (World::translate()), and all attached objects, with their motion states. Nothing is swept, and
  /// velocities, loads, touches and sums go on; positions are rounded to btScalar. The regions of forces of
  /// btFluid::addForce() move, too. The other objects of Bullet's world are the caller's to move. Refuses
  /// what World::translate() and saveState() refuse, and changes nothing then. Call it between steps.
  Status translate(const btVector3& offset);

  /// Does nothing: actions run before Bullet solves the cloth.
  void updateAction(btCollisionWorld*, btScalar) override {}
  /// Wireframe: particles as short lines along their motion, from dark blue (at rest) to white (fast).
  /// Contact points or normals: contacts of the last step.
  void debugDraw(btIDebugDraw* drawer) override;

 private:
  friend class btFluidSoftBodySolver;
  friend class btFluidQuery;
  const StepReport& couple(double dt, bool updateNormals);
  void detachAbsent(const btAlignedObjectArray<btSoftBody*>& bodies);
  void tellListeners();
  void forgetListeners();

  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// A soft-body solver that couples in every sub-step. Pass it as fifth argument of btSoftRigidDynamicsWorld
/// or btSoftMultiBodyDynamicsWorld. It has the functions of btFluidCoupling.
///
/// Every sub-step detaches soft bodies that the world does not have, with a message, so that a cloth may be
/// deleted after removeSoftBody() alone. Other calls before that sub-step, as saveState(), would read it:
/// where they come, call removeCloth() or setCollisionWorld().
class btFluidSoftBodySolver : public btDefaultSoftBodySolver {
 public:
  btFluidSoftBodySolver();
  ~btFluidSoftBodySolver() override;

  /// btFluidCoupling::addFluid().
  Status addFluid(btFluid* fluid) { return m_coupling.addFluid(fluid); }
  /// btFluidCoupling::removeFluid().
  void removeFluid(btFluid* fluid) { m_coupling.removeFluid(fluid); }
  /// btFluidCoupling::addCloth().
  Status addCloth(btSoftBody* cloth, btScalar thickness, const SlipSettings& slip = {}) {
    return m_coupling.addCloth(cloth, thickness, slip);
  }
  /// btFluidCoupling::addCloth().
  Status addCloth(btSoftBody* cloth, const SurfaceSettings& settings = {}, bool mayHoldPins = true,
                  bool weldNodes = true) {
    return m_coupling.addCloth(cloth, settings, mayHoldPins, weldNodes);
  }
  /// btFluidCoupling::removeCloth().
  void removeCloth(btSoftBody* cloth) { m_coupling.removeCloth(cloth); }
  /// btFluidCoupling::addCollisionObject().
  Status addCollisionObject(btCollisionObject* object, btScalar thickness, const SlipSettings& slip = {}) {
    return m_coupling.addCollisionObject(object, thickness, slip);
  }
  /// btFluidCoupling::addCollisionObject().
  Status addCollisionObject(btCollisionObject* object, const SurfaceSettings& settings = {}) {
    return m_coupling.addCollisionObject(object, settings);
  }
  /// btFluidCoupling::removeCollisionObject().
  void removeCollisionObject(btCollisionObject* object) { m_coupling.removeCollisionObject(object); }
  /// btFluidCoupling::addRigidBody().
  Status addRigidBody(btRigidBody* body, btScalar thickness, const SlipSettings& slip = {}) {
    return m_coupling.addRigidBody(body, thickness, slip);
  }
  /// btFluidCoupling::addRigidBody().
  Status addRigidBody(btRigidBody* body, const SurfaceSettings& settings = {}) {
    return m_coupling.addRigidBody(body, settings);
  }
  /// btFluidCoupling::removeRigidBody().
  void removeRigidBody(btRigidBody* body) { m_coupling.removeRigidBody(body); }
  /// btFluidCoupling::resetMotion().
  void resetMotion(btSoftBody* cloth) { m_coupling.resetMotion(cloth); }
  /// btFluidCoupling::resetMotion().
  void resetMotion(btCollisionObject* object) { m_coupling.resetMotion(object); }

  /// btFluidCoupling::setCollisionWorld().
  void setCollisionWorld(const btCollisionWorld* world) { m_coupling.setCollisionWorld(world); }
  /// btFluidCoupling::takeMessages().
  std::vector<std::string> takeMessages() { return m_coupling.takeMessages(); }

  /// btFluidCoupling::addListener().
  Status addListener(btFluidListener* listener) { return m_coupling.addListener(listener); }
  /// btFluidCoupling::removeListener().
  void removeListener(btFluidListener* listener) { m_coupling.removeListener(listener); }
  /// btFluidCoupling::takeReport().
  StepReport takeReport() { return m_coupling.takeReport(); }

  /// btFluidCoupling::saveState().
  Status saveState(std::vector<std::uint8_t>* out, btCollisionWorld* world = nullptr) const {
    return m_coupling.saveState(out, world);
  }
  /// btFluidCoupling::restoreState().
  Status restoreState(Span<const std::uint8_t> saved, btCollisionWorld* world = nullptr) {
    return m_coupling.restoreState(saved, world);
  }

  /// btFluidCoupling::translate().
  Status translate(const btVector3& offset) { return m_coupling.translate(offset); }

  /// btFluidCoupling::setCarriesWater().
  void setCarriesWater(bool carries) { m_coupling.setCarriesWater(carries); }
  /// btFluidCoupling::getCarriesWater().
  bool getCarriesWater() const { return m_coupling.getCarriesWater(); }
  /// Couples at every n-th of Bullet's sub-steps (n ≥ 1), over the straight line from the last coupling.
  void setCouplingInterval(int n);
  /// The number of Bullet's sub-steps between two couplings.
  int getCouplingInterval() const { return m_interval; }
  /// Whether sub-steps end with new normals of the soft bodies (the default). Oilskin does not read them.
  /// Bullet does where `m_cfg` has drag, lift, pressure or conservation of volume (kDP, kLF, kPR, kVC): such
  /// bodies always get theirs. A program that makes several sub-steps between two pictures may switch it off
  /// for all but the last one.
  void setUpdatesNormals(bool updates) { m_updatesNormals = updates; }
  /// Whether sub-steps end with new normals of the soft bodies.
  bool getUpdatesNormals() const { return m_updatesNormals; }
  /// The coupling behind the solver.
  btFluidCoupling& getCoupling() { return m_coupling; }
  /// The same, read-only.
  const btFluidCoupling& getCoupling() const { return m_coupling; }
  /// The report of the last coupled step.
  const StepReport& getReport() const;

  /// Is called by Bullet at the start of each of its sub-steps with the soft bodies of the world.
  void optimize(btAlignedObjectArray<btSoftBody*>& softBodies, bool forceUpdate = false) override;
  /// Is called by Bullet after optimize().
  void predictMotion(btScalar solverdt) override;
  /// Is called by Bullet at the end of each of its sub-steps; couples.
  void updateSoftBodies() override;

 private:
  btFluidCoupling m_coupling;
  int m_interval = 1;
  bool m_updatesNormals = true;
};

}  // namespace oilskin::bullet
