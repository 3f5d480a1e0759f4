/// Water for Bullet's soft bodies, in Bullet's own manner: the user creates and owns everything, we keep raw
/// pointers. Couples in updateSoftBodies(), the last call of every internal sub-step, or in an explicit
/// step(dt).
///
/// Never touched: rest lengths, masses, tick callbacks, user pointers, tags.
#pragma once

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <btBulletDynamicsCommon.h>

#include <memory>

#include "oilskin/world.h"

// Single and double precision Bullet share header and symbol names; a program compiled for one and linked
// with the adapter of the other would corrupt memory. It fails to link instead, and the missing symbol says
// why.
#ifdef BT_USE_DOUBLE_PRECISION
#define OILSKIN_BULLET_GUARD oilskin_bullet_adapter_was_built_for_double_precision
static_assert(sizeof(btScalar) == sizeof(double),
              "BT_USE_DOUBLE_PRECISION must be defined before Bullet's headers");
#else
#define OILSKIN_BULLET_GUARD oilskin_bullet_adapter_was_built_for_single_precision
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

namespace oilskin::bullet {

class btFluidCoupling;

/// A fluid: settings, particles and emitters. One per coupling. May be deleted while it is in one.
class btFluid {
 public:
  /// Water of that rest distance [m], with default settings; the kill box is ±10 m.
  explicit btFluid(btScalar restDistance = btScalar(0.005));
  btFluid(const FluidSettings& fluid, const WorldSettings& world, const ContactSettings& contact);
  ~btFluid();
  btFluid(const btFluid&) = delete;
  btFluid& operator=(const btFluid&) = delete;

  /// A round nozzle that runs from now on. Position and radius in m, speed in m/s, any length of direction >
  /// 0.
  Status addJet(const btVector3& position, const btVector3& direction, btScalar speed,
                btScalar radius = btScalar(0.025));
  /// Fills a box with fluid at the next step.
  Status addBox(const btVector3& boxMin, const btVector3& boxMax,
                const btVector3& velocity = btVector3(0, 0, 0));

  int getNumParticles() const;
  btVector3 getPosition(int i) const;
  btVector3 getVelocity(int i) const;
  /// Three floats a particle, `strideBytes` apart (≥ 12); `out` holds getNumParticles() of them.
  void copyPositions(float* out, int strideBytes = 12) const;
  void copyVelocities(float* out, int strideBytes = 12) const;

  World& getWorld() { return *m_world; }
  const World& getWorld() const { return *m_world; }

 private:
  friend class btFluidCoupling;
  std::unique_ptr<World> m_world;
  btFluidCoupling* m_coupling = nullptr;
};

/// Couples one fluid with soft bodies and collision objects. Add it to a world with addAction() for debug
/// drawing only: actions run before Bullet solves the cloth, so nothing is coupled there.
///
/// Whatever is attached must be removed from the coupling before it is deleted. Bodies may be cut, refined
/// and re-ordered while they are attached: they are then new surfaces.
class btFluidCoupling : public btActionInterface {
 public:
  explicit btFluidCoupling(btFluid* fluid = nullptr);
  ~btFluidCoupling() override;
  btFluidCoupling(const btFluidCoupling&) = delete;
  btFluidCoupling& operator=(const btFluidCoupling&) = delete;

  /// One fluid per coupling; a second one is refused. Surfaces added before the fluid are attached with it.
  Status addFluid(btFluid* fluid);
  void removeFluid(btFluid* fluid);
  btFluid* getFluid() const;

  /// Refuses soft bodies without faces, thicknesses below 4 δ, bodies that are attached already. A refusal
  /// attaches nothing. Before there is a fluid, δ is not known: addFluid() may then refuse.
  ///
  /// mayHoldPins: where pins close on a particle from both sides they are stopped for a step, and counted.
  /// weldNodes: nodes that lie at bit-equal positions now (an unwelded mesh) are one node of their common
  /// mass for contact and are kept together: at every coupling they are put to their centre of mass with
  /// their common velocity, for Bullet itself lets them fall apart, and the open seam would be a hole. Off
  /// for sheets that shall part.
  Status addCloth(btSoftBody* cloth, btScalar thickness, const SlipSettings& slip = {});
  Status addCloth(btSoftBody* cloth, const SurfaceSettings& settings, bool mayHoldPins = true,
                  bool weldNodes = true);
  void removeCloth(btSoftBody* cloth);
  /// Static and kinematic objects; dynamic rigid bodies are refused. Triangle meshes (all concave shapes that
  /// list their triangles), boxes and convex hulls exactly, without the margin that Bullet adds outside of
  /// hulls; spheres by 1280 triangles around them; other convex shapes by the hull of 642 of their points;
  /// static planes by their part inside the kill box; compounds of these. Transform and scaling are read at
  /// every step.
  Status addCollisionObject(btCollisionObject* object, btScalar thickness, const SlipSettings& slip = {});
  Status addCollisionObject(btCollisionObject* object, const SurfaceSettings& settings);
  void removeCollisionObject(btCollisionObject* object);

  /// The positions of the cloth at the next step are a teleport, not a motion.
  void resetMotion(btSoftBody* cloth);
  void resetMotion(btCollisionObject* object);

  /// Gravity of the fluid at every step: that of the first cloth's btSoftBodyWorldInfo while a cloth is
  /// attached (default), or what btFluid::getWorld().set_gravity() and WorldSettings say.
  void setUseClothGravity(bool use);

  /// One coupled step for engines that own their world: call it after stepSimulation(). dt [s] is the time
  /// that the cloth has moved since the last call: sub-steps run × their length. 0 (no sub-step was run) does
  /// nothing, and the motion counts with the next step.
  const StepReport& step(btScalar dt);
  const StepReport& getReport() const;

  /// Impulses given to the nodes in the last step [N s], one per node in Bullet's order; null when not
  /// attached. For pins: the reaction.
  const std::vector<Vec3>* getNodeImpulses(const btSoftBody* cloth) const;
  const SurfaceMotion* getSurface(const btSoftBody* cloth) const;
  const SurfaceMotion* getSurface(const btCollisionObject* object) const;

  // btActionInterface
  void updateAction(btCollisionWorld*, btScalar) override {}
  /// Wireframe: particles as short lines along their velocity, dark blue (still) to white (fast). Contact
  /// points or normals: contacts of the last step.
  void debugDraw(btIDebugDraw* drawer) override;

 private:
  friend class btFluidSoftBodySolver;
  const StepReport& couple(double dt, bool updateNormals);

  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Pass it as fifth argument of btSoftRigidDynamicsWorld or btSoftMultiBodyDynamicsWorld.
class btFluidSoftBodySolver : public btDefaultSoftBodySolver {
 public:
  btFluidSoftBodySolver();
  ~btFluidSoftBodySolver() override;

  Status addFluid(btFluid* fluid) { return m_coupling.addFluid(fluid); }
  void removeFluid(btFluid* fluid) { m_coupling.removeFluid(fluid); }
  Status addCloth(btSoftBody* cloth, btScalar thickness, const SlipSettings& slip = {}) {
    return m_coupling.addCloth(cloth, thickness, slip);
  }
  Status addCloth(btSoftBody* cloth, const SurfaceSettings& settings, bool mayHoldPins = true,
                  bool weldNodes = true) {
    return m_coupling.addCloth(cloth, settings, mayHoldPins, weldNodes);
  }
  void removeCloth(btSoftBody* cloth) { m_coupling.removeCloth(cloth); }
  Status addCollisionObject(btCollisionObject* object, btScalar thickness, const SlipSettings& slip = {}) {
    return m_coupling.addCollisionObject(object, thickness, slip);
  }
  Status addCollisionObject(btCollisionObject* object, const SurfaceSettings& settings) {
    return m_coupling.addCollisionObject(object, settings);
  }
  void removeCollisionObject(btCollisionObject* object) { m_coupling.removeCollisionObject(object); }
  void resetMotion(btSoftBody* cloth) { m_coupling.resetMotion(cloth); }
  void resetMotion(btCollisionObject* object) { m_coupling.resetMotion(object); }

  /// Couple at every n-th Bullet sub-step only (n ≥ 1), over the straight line from the last coupling.
  void setCouplingInterval(int n);
  int getCouplingInterval() const { return m_interval; }
  btFluidCoupling& getCoupling() { return m_coupling; }
  const btFluidCoupling& getCoupling() const { return m_coupling; }
  /// Of the last coupled step.
  const StepReport& getReport() const;

  void predictMotion(btScalar solverdt) override;
  void updateSoftBodies() override;

 private:
  btFluidCoupling m_coupling;
  int m_interval = 1;
  int m_pending = 0;         // sub-steps since the last coupling
  double m_pendingTime = 0;  // [s], and their length
};

}  // namespace oilskin::bullet
