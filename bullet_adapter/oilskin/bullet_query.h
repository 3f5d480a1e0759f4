/// @file
/// Questions of a game about the water between two steps.
#pragma once

#include "oilskin/bullet.h"
#include "oilskin/water_query.h"

namespace oilskin::bullet {

/// Where a ray enters the water.
struct btFluidRayResult {
  /// The place on the ray, 0 (from) … 1 (to).
  btScalar m_fraction = 1;
  /// [m]
  btVector3 m_point = btVector3(0, 0, 0);
  /// From the particle to the point, unit.
  btVector3 m_normal = btVector3(0, 0, 0);
  /// The index of the particle in btFluid.
  int m_particle = -1;
};

/// A copy of the water of a fluid, made between two steps. It does not follow the fluid, which may step and
/// be deleted meanwhile. All functions are const and write nothing but their result: any number of threads
/// may call them at the same time. To make one takes O(n log n) time: make one per step, and ask it all.
class btFluidQuery {
 public:
  /// Copies particles, and thickness and liquid of the attached cloth. One thread, not during a step.
  explicit btFluidQuery(const btFluid& fluid);

  /// The volume at rest density [m³] of the particles whose centre is in the closed box [m]; −1 for boxes
  /// that are not finite or have min > max.
  btScalar getVolume(const btVector3& aabbMin, const btVector3& aabbMax) const;
  /// The same in a convex shape, as btFluid::removeParticles() reads it; −1 where that returns −1.
  btScalar getVolume(const btConvexShape* shape, const btTransform& transform) const;
  /// The first ball of radius dx/2 around a particle that the ray enters. False, and nothing is written,
  /// where it enters none, or from = to, or numbers are not finite. A ball in which the ray starts is not
  /// hit.
  bool rayTest(const btVector3& from, const btVector3& to, btFluidRayResult& result) const;
  /// The level of the water above (negative: below) a point, along `up` of any length: WaterQuery::level().
  /// False, and nothing is written, where there is no water on the line, up is 0, or numbers are not finite.
  bool getLevel(const btVector3& point, const btVector3& up, btScalar& level) const;
  /// [kg/m³]: WaterSample::density. 0 for a point that is not finite.
  btScalar getDensity(const btVector3& point) const;
  /// [m/s]: WaterSample::velocity. Zero away from water, and for a point that is not finite.
  btVector3 getVelocityAt(const btVector3& point) const;
  /// Whether the centre of a particle is within dx. False for a point that is not finite.
  bool isWet(const btVector3& point) const;
  /// Whether a node has absorbed liquid, or the centre of a particle is within dx + the thickness of the
  /// cloth. Reads the present position of the node. False for cloth that was not attached, and nodes it does
  /// not have.
  bool isNodeWet(const btSoftBody* cloth, int node) const;
  /// The index of the nearest particle; −1 without particles, and for a point that is not finite.
  int findNearest(const btVector3& point) const;

  /// The query behind it.
  const WaterQuery& getQuery() const { return m_query; }

 private:
  struct Cloth {
    const btSoftBody* body;
    double reach;                // [m]
    std::vector<bool> absorbed;  // per node in Bullet's order; empty: none has
  };

  WaterQuery m_query;
  std::vector<Cloth> m_cloths;
};

}  // namespace oilskin::bullet
