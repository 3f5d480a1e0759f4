/// @file
/// The fluid of Bullet's interface. Include oilskin/bullet.h, which guards against a mismatch of precisions.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <LinearMath/btTransform.h>

#include <memory>
#include <vector>

#include "oilskin/force_fields.h"
#include "oilskin/world.h"

namespace oilskin::bullet {

class btFluidCoupling;
class btFluidEmitter;
class btFluidForce;
class btFluidSink;

/// A fluid: settings, particles and emitters. It belongs to at most one coupling, and may be deleted before
/// it.
class btFluid {
 public:
  /// Water with default settings and the rest distance `restDistance` [m] of particles; the kill box is ±10
  /// m.
  explicit btFluid(btScalar restDistance = btScalar(0.005));
  /// A fluid with all settings.
  btFluid(const FluidSettings& fluid, const WorldSettings& world, const ContactSettings& contact);
  ~btFluid();
  btFluid(const btFluid&) = delete;
  btFluid& operator=(const btFluid&) = delete;

  /// Adds a round nozzle that starts with the next step. Position and radius in m, speed in m/s; the
  /// direction has any length > 0.
  Status addJet(const btVector3& position, const btVector3& direction, btScalar speed,
                btScalar radius = btScalar(0.025));
  /// Fills a box with fluid at the next step, with as many layers as fit: a side of 6.7 spacings has 6, in
  /// the middle.
  Status addBox(const btVector3& boxMin, const btVector3& boxMax,
                const btVector3& velocity = btVector3(0, 0, 0));

  /// Adds an emitter that the caller owns and may move, stop and delete (oilskin/bullet_emitter.h). It starts
  /// with the next step. Refuses null, an emitter that is in a fluid, and one that lies outside the kill box.
  Status addEmitter(btFluidEmitter* emitter);
  /// Removes an emitter; its water stays. One that is not here is ignored.
  void removeEmitter(btFluidEmitter* emitter);

  /// Adds a sink that the caller owns and may move and delete (oilskin/bullet_sink.h). Refuses null and a
  /// sink that is in a fluid.
  Status addSink(btFluidSink* sink);
  /// Removes a sink. One that is not here is ignored.
  void removeSink(btFluidSink* sink);
  /// Adds a force field that the caller owns and may change and delete (oilskin/bullet_force.h). Refuses
  /// null, a field that is in a fluid, and numbers that are out of range.
  Status addForce(btFluidForce* force);
  /// Removes a force field. One that is not here is ignored.
  void removeForce(btFluidForce* force);
  /// The age [s], > 0, at which particles end; infinity: none does (default). World::set_max_age().
  Status setMaxAge(btScalar seconds);

  /// Removes the particles in the closed box [m] and returns their number; −1, and nothing is removed, where
  /// the box is not finite or has min > max on an axis. Call it between steps. The report of the next step
  /// counts what was removed, with mass, momentum and energy (World::remove_particles()). The indices i of
  /// the other particles change, their ids do not. Liquid in wet cloth stays there, and emitters go on.
  int removeParticles(const btVector3& aabbMin, const btVector3& aabbMax);
  /// The same for the particles in a convex shape, surface included. Spheres and capsules are round; boxes,
  /// tetrahedra and convex hulls exact, without the margin that Bullet adds outside of hulls; other shapes
  /// the hull of 642 of their points. −1 for null, a transform that is not finite or not invertible, and
  /// shapes that are not finite or have no volume.
  int removeParticles(const btConvexShape* shape, const btTransform& transform);
  /// Removes all particles. Emitters go on.
  void clear();
  /// Where there are n particles, none is added: what emitters would start is lost, and counted in
  /// StepReport::limited_starts; cloth keeps what would drip from it. Emission goes on when particles have
  /// left. A box that does not fit is filled in part. A smaller limit removes no particle. n ≤ 0: no limit
  /// (default).
  void setMaxParticles(int n);
  /// 0 = no limit.
  int getMaxParticles() const;
  /// The wall time that a step of the coupling may take [s], 0 = no limit (default); refuses other numbers
  /// below 0 and those that are not finite. Where it is too short, iterations and fluid sub-steps are left
  /// out (WorldSettings::step_budget), and the report says so. Nothing crosses.
  Status setStepBudget(btScalar seconds);
  /// [s]; 0 = no limit.
  btScalar getStepBudget() const;

  /// [m/s²]. Refuses numbers that are not finite, and is refused while the coupling takes the gravity of a
  /// cloth: set that cloth's btSoftBodyWorldInfo::m_gravity, or call setUseClothGravity(false) first.
  Status setGravity(const btVector3& gravity);
  /// [m/s²]; while the coupling takes the gravity of a cloth, that of the last step.
  btVector3 getGravity() const;

  /// The number of particles.
  int getNumParticles() const;
  /// A number that the particle i keeps for all its life; no other particle has it. The largest 64-bit number
  /// for i outside 0 … getNumParticles() − 1.
  std::uint64_t getId(int i) const;
  /// The mass of all particles [kg]; not what cloth has absorbed.
  btScalar getMass() const;
  /// Their volume at the rest density [m³].
  btScalar getVolume() const;
  /// [m]. Zero for i outside 0 … getNumParticles() − 1. A step may give a particle another place in this
  /// order; getId() stays.
  btVector3 getPosition(int i) const;
  /// How fast it moves [m/s]: World::motions(). Zero for i outside 0 … getNumParticles() − 1.
  btVector3 getVelocity(int i) const;
  /// Writes three floats per particle [m], `strideBytes` ≥ 12 apart, getNumParticles() times. Writes nothing
  /// where `out` is null or the stride smaller.
  void copyPositions(float* out, int strideBytes = 12) const;
  /// Writes three floats per particle [m/s], `strideBytes` ≥ 12 apart, getNumParticles() times:
  /// World::motions(). Writes nothing where `out` is null or the stride smaller.
  void copyVelocities(float* out, int strideBytes = 12) const;

  /// The world behind the fluid, with all that Bullet's interface does not show.
  World& getWorld() { return *m_world; }
  /// The same, read-only.
  const World& getWorld() const { return *m_world; }

 private:
  friend class btFluidCoupling;
  friend class btFluidQuery;
  friend class btFluidForce;
  void releaseEmitters();
  void releaseSinksAndForces();
  void forgetFields();

  std::unique_ptr<World> m_world;
  btFluidCoupling* m_coupling = nullptr;
  std::vector<btFluidEmitter*> m_emitters;
  std::vector<btFluidSink*> m_sinks;
  std::vector<btFluidForce*> m_forces;
  std::unique_ptr<ForceFields> m_fields;  // null where the fluid has no forces
};

}  // namespace oilskin::bullet
