/// @file
/// Force fields as objects of Bullet's kind: the user creates, changes and owns them, and adds them to a
/// btFluid.
#pragma once

#include "oilskin/bullet.h"

namespace oilskin::bullet {

/// A force field. It is in at most one fluid; either may be deleted first. Call it between steps. Refusals
/// change nothing. oilskin/force_fields.h says what each field does.
class btFluidForce {
 public:
  virtual ~btFluidForce();
  btFluidForce(const btFluidForce&) = delete;
  btFluidForce& operator=(const btFluidForce&) = delete;

  /// Acts within a convex shape, as in btFluid::removeParticles(), which is copied; null: everywhere
  /// (default). Refuses shapes without a volume, and a transform that is not finite or not a rigid motion.
  Status setRegion(const btConvexShape* shape, const btTransform& transform = btTransform::getIdentity());
  /// Whether it acts (default).
  Status setEnabled(bool enabled);
  /// Whether it acts.
  bool isEnabled() const;

  /// The fluid that it is in; null = none.
  btFluid* getFluid() const { return m_fluid; }
  /// Its handle in the fluid's force fields; none without a fluid.
  ForceId getForceId() const { return m_id; }

 protected:
  /// Of a kind.
  explicit btFluidForce(Force force) : m_force(std::move(force)) {}
  /// Replaces the field by another of its kind.
  Status change(const Force& force);
  /// The field as it is.
  template <class Kind>
  Kind field() const {
    return std::get<Kind>(current());
  }

 private:
  friend class btFluid;
  friend struct ForceMemory;
  ForceFields* fields() const;
  Force current() const;
  Status attach(btFluid* fluid);
  void detach();

  Force m_force;
  bool m_enabled = true;
  btFluid* m_fluid = nullptr;
  ForceId m_id;
};

/// The same acceleration everywhere in its region, beside gravity.
class btFluidUniformForce : public btFluidForce {
 public:
  /// [m/s²]
  explicit btFluidUniformForce(const btVector3& acceleration = btVector3(0, 0, 0));
  ~btFluidUniformForce() override = default;
  /// [m/s²]. Refuses numbers that are not finite.
  Status setAcceleration(const btVector3& acceleration);
  /// [m/s²]
  btVector3 getAcceleration() const;
};

/// An acceleration around an axis: it grows up to `radius`, where it is `strength`, and falls with 1/distance
/// beyond.
class btFluidVortex : public btFluidForce {
 public:
  /// A point of the axis [m], its direction (any length > 0), radius [m], > 0, and largest acceleration
  /// [m/s²].
  btFluidVortex(const btVector3& center, const btVector3& axis, btScalar radius, btScalar strength);
  ~btFluidVortex() override = default;
  /// A point of the axis [m] and its direction, of any length > 0.
  Status setAxis(const btVector3& center, const btVector3& axis);
  /// [m/s²]
  Status setStrength(btScalar strength);
  /// [m/s²]
  btScalar getStrength() const;
};

/// Wind on the free surface of the water. Bullet's cloth has its own: btSoftBody::setWindVelocity().
class btFluidWind : public btFluidForce {
 public:
  /// [m/s]
  explicit btFluidWind(const btVector3& velocity = btVector3(0, 0, 0));
  ~btFluidWind() override = default;
  /// [m/s]. Refuses numbers that are not finite.
  Status setVelocity(const btVector3& velocity);
  /// [m/s]
  btVector3 getVelocity() const;
  /// Of the air: density [kg/m³], and the coefficients of the area that faces the wind and of the whole area;
  /// all ≥ 0.
  Status setAir(btScalar density, btScalar dragCoefficient, btScalar frictionCoefficient);
};

}  // namespace oilskin::bullet
