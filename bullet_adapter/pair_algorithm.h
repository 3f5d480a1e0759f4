/// What collision algorithms of Bullet's keep of a pair of objects: contact points.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include "pair_state.h"

namespace oilskin::bullet {

/// The fields of a contact point. With one point: f(field); with two: f(to, from).
template <class F, class... P>
void each_point_field(const F& f, P&... p) {
  f(p.m_localPointA...), f(p.m_localPointB...), f(p.m_positionWorldOnB...), f(p.m_positionWorldOnA...);
  f(p.m_normalWorldOnB...), f(p.m_distance1...), f(p.m_combinedFriction...),
      f(p.m_combinedRollingFriction...);
  f(p.m_combinedSpinningFriction...), f(p.m_combinedRestitution...), f(p.m_partId0...), f(p.m_partId1...);
  f(p.m_index0...), f(p.m_index1...), f(p.m_contactPointFlags...), f(p.m_appliedImpulse...);
  f(p.m_prevRHS...), f(p.m_appliedImpulseLateral1...), f(p.m_appliedImpulseLateral2...);
  f(p.m_contactMotion1...), f(p.m_contactMotion2...), f(p.m_contactCFM...), f(p.m_contactERP...);
  f(p.m_frictionCFM...), f(p.m_lifeTime...), f(p.m_lateralFrictionDir1...), f(p.m_lateralFrictionDir2...);
}

/// The algorithms of soft bodies remember nothing.
bool is_of_soft(const btBroadphasePair& pair);
btManifoldArray manifolds_of(const btBroadphasePair& pair);
/// Gives a pair an algorithm with the saved manifolds, whose points may be others; false where that is not
/// possible. `dt` is the length of the last step [s].
bool fit_algorithm(const PairState::Pair& saved, const std::vector<const PairState::Manifold*>& manifolds,
                   btBroadphasePair& pair, btCollisionWorld& world, btScalar dt);
/// Gives a manifold the saved points.
void apply_manifold(const PairState::Manifold& saved, btPersistentManifold& manifold,
                    const btBroadphasePair& pair);
/// Those in `first` come first, in their order.
void sort_manifolds(const std::vector<btPersistentManifold*>& first, btCollisionDispatcher& dispatcher);

}  // namespace oilskin::bullet
