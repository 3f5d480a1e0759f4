/// @file
/// Emitters as objects of Bullet's kind: the user creates, moves and owns them, and adds them to a btFluid.
#pragma once

#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>

#include "oilskin/bullet.h"

namespace oilskin::bullet {

/// What lets water into a fluid. In its own frame the water leaves along −y. An emitter is in at most one
/// fluid; either may be deleted first. Call it between steps. Refusals change nothing. World::move_emitter()
/// and its neighbours say more of each call.
class btFluidEmitter {
 public:
  virtual ~btFluidEmitter();
  btFluidEmitter(const btFluidEmitter&) = delete;
  btFluidEmitter& operator=(const btFluidEmitter&) = delete;

  /// The emitter moves there within `duration` [s], on a straight line and by the shortest turn; 0: within
  /// the next coupled step. Give the length of the frame where stepSimulation() makes several sub-steps. The
  /// first place that it is given is no motion, before addEmitter() or between that and the next step.
  /// Refuses a transform that is not finite or not a rigid motion.
  Status setWorldTransform(const btTransform& transform, btScalar duration = 0);
  /// The emitter is there at once: nothing starts on the way.
  Status teleport(const btTransform& transform);
  /// Where it is, or moves to.
  const btTransform& getWorldTransform() const { return m_transform; }

  /// The speed at which water leaves [m/s], ≥ 0.
  Status setSpeed(btScalar speed);
  /// [m/s]
  btScalar getSpeed() const { return m_speed; }
  /// Whether water leaves (default). The phase is kept meanwhile.
  Status setEnabled(bool enabled);
  /// Whether water leaves.
  bool isEnabled() const { return m_enabled; }
  /// The velocity of what carries the emitter [m/s], added to that of the water; 0 at first.
  Status setInheritedVelocity(const btVector3& velocity);
  /// [m/s]
  const btVector3& getInheritedVelocity() const { return m_inheritedVelocity; }

  /// The volume of what has come from it [m³], in all fluids that it was in.
  btScalar getEmittedVolume() const;
  /// Whether no water comes from it any more: a box or mesh that was filled. It remains in its fluid.
  bool hasEnded() const;
  /// The fluid that it is in; null = none.
  btFluid* getFluid() const { return m_fluid; }
  /// Its handle in the fluid's world; none without a fluid.
  EmitterId getEmitterId() const { return m_id; }

 protected:
  /// With a speed [m/s].
  explicit btFluidEmitter(btScalar speed) : m_speed(speed) {}
  /// The world that it is in; null = none.
  World* world() const;

 private:
  friend class btFluid;
  friend class btFluidCoupling;
  friend struct EmitterMemory;
  /// Adds it with the speed 1 m/s.
  virtual Status addTo(World& world, const EmitterPose& pose, EmitterId* id) const = 0;
  /// The centre of the emitter in its own frame [m].
  virtual Vec3 center() const { return Vec3::Zero(); }
  Status place(const btTransform& transform, double duration, bool jumps);
  EmitterPose pose(const btTransform& transform) const;
  Status attach(btFluid* fluid);
  void detach();

  btTransform m_transform = btTransform::getIdentity();
  btScalar m_speed;
  bool m_enabled = true;
  btVector3 m_inheritedVelocity = btVector3(0, 0, 0);
  btFluid* m_fluid = nullptr;
  EmitterId m_id;
  double m_volumeBefore = 0;
  bool m_isPlaced = false;
  double m_addedAt = 0;  // [s]
};

/// A round nozzle, a hose or a tap, with the flow π r² × speed.
class btFluidDiscEmitter : public btFluidEmitter {
 public:
  /// Radius [m], half a spacing to 1000 spacings of the fluid; speed [m/s].
  explicit btFluidDiscEmitter(btScalar radius, btScalar speed = 1)
      : btFluidEmitter(speed), m_radius(radius) {}
  ~btFluidDiscEmitter() override = default;

 private:
  Status addTo(World& world, const EmitterPose& pose, EmitterId* id) const override;
  btScalar m_radius;
};

/// A box that is filled once, at the first step in which it is enabled.
class btFluidBoxEmitter : public btFluidEmitter {
 public:
  /// Half of each edge [m].
  explicit btFluidBoxEmitter(const btVector3& halfExtents) : btFluidEmitter(0), m_halfExtents(halfExtents) {}
  ~btFluidBoxEmitter() override = default;

 private:
  Status addTo(World& world, const EmitterPose& pose, EmitterId* id) const override;
  btVector3 m_halfExtents;
};

/// A closed surface that is filled once, at the first step in which it is enabled.
class btFluidMeshEmitter : public btFluidEmitter {
 public:
  /// A convex shape or a triangle mesh, as in btFluidCoupling::addCollisionObject(); it is copied. What has
  /// no triangles is refused by btFluid::addEmitter().
  explicit btFluidMeshEmitter(const btCollisionShape* shape);
  /// The triangles of a mesh, for example btTriangleMesh, which are copied.
  explicit btFluidMeshEmitter(const btStridingMeshInterface* mesh);
  ~btFluidMeshEmitter() override = default;

 private:
  Status addTo(World& world, const EmitterPose& pose, EmitterId* id) const override;
  Vec3 center() const override;
  void read(const btCollisionShape& shape);
  MeshEmitter m_mesh;
  Status m_status;
};

/// Drops at random places of a rectangle in the plane y = 0 of its frame.
class btFluidRainEmitter : public btFluidEmitter {
 public:
  /// Half of the edges [m], drops per second in all, their radius [m] (below one spacing a drop is one
  /// particle) and speed [m/s].
  btFluidRainEmitter(btScalar halfX, btScalar halfZ, btScalar dropsPerSecond, btScalar dropRadius = 0,
                     btScalar speed = 1);
  ~btFluidRainEmitter() override = default;
  /// [1/s], > 0.
  Status setDropsPerSecond(btScalar rate);
  /// [1/s]
  btScalar getDropsPerSecond() const { return m_dropsPerSecond; }

 private:
  friend struct EmitterMemory;
  Status addTo(World& world, const EmitterPose& pose, EmitterId* id) const override;
  btScalar m_halfX, m_halfZ, m_dropsPerSecond, m_dropRadius;
};

}  // namespace oilskin::bullet
