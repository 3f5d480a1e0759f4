#include "pair_algorithm.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace oilskin::bullet {

namespace {

/// Lets an object be awake and where it was `dt` ago [s], for as long as this lives: Bullet finds contacts
/// before it moves objects.
class Before {
 public:
  Before(btCollisionObject& object, btScalar dt)
      : object_(object), transform_(object.getWorldTransform()), activation_(object.getActivationState()) {
    // These are the velocities by which Bullet moved it.
    if (btRigidBody::upcast(&object))
      btTransformUtil::integrateTransform(transform_, object.getInterpolationLinearVelocity(),
                                          object.getInterpolationAngularVelocity(), -dt,
                                          object.getWorldTransform());
    object.forceActivationState(ACTIVE_TAG);
  }
  ~Before() {
    object_.setWorldTransform(transform_);
    object_.forceActivationState(activation_);
  }
  Before(const Before&) = delete;
  Before& operator=(const Before&) = delete;

 private:
  btCollisionObject& object_;
  btTransform transform_;
  int activation_;
};

btCollisionObject& object_of(const btBroadphaseProxy* proxy) {
  return *static_cast<btCollisionObject*>(proxy->m_clientObject);
}

/// As Bullet does at the first step in which a pair may touch.
void make_algorithm(btBroadphasePair& pair, btCollisionWorld& world, btScalar dt) {
  btCollisionObject &a = object_of(pair.m_pProxy0), &b = object_of(pair.m_pProxy1);
  const Before a_before(a, dt), b_before(b, dt);
  const btCollisionObjectWrapper wrap_a(nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1);
  const btCollisionObjectWrapper wrap_b(nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1);
  pair.m_algorithm =
      world.getDispatcher()->findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  if (!pair.m_algorithm) return;
  btManifoldResult result(&wrap_a, &wrap_b);
  pair.m_algorithm->processCollision(&wrap_a, &wrap_b, world.getDispatchInfo(), &result);
}

/// Do these belong to the same parts of compounds, as far as that is known?
bool is_of_same_parts(const PairState::Manifold& saved, const btPersistentManifold& here) {
  if (saved.points.empty() || here.getNumContacts() == 0) return true;
  const btManifoldPoint &a = saved.points[0], &b = here.getContactPoint(0);
  const auto is_compound = [](const btCollisionObject* o) { return o->getCollisionShape()->isCompound(); };
  return (!is_compound(here.getBody0()) || a.m_index0 == b.m_index0) &&
         (!is_compound(here.getBody1()) || a.m_index1 == b.m_index1);
}

bool has_manifolds(const std::vector<const PairState::Manifold*>& saved, const btBroadphasePair& pair) {
  const btManifoldArray here = manifolds_of(pair);
  if (here.size() != static_cast<int>(saved.size())) return false;
  for (const PairState::Manifold* m : saved)
    if (!is_of_same_parts(*m, *here[static_cast<int>(m->place)])) return false;
  return true;
}

}  // namespace

bool is_of_soft(const btBroadphasePair& pair) {
  const auto is_soft = [](const btBroadphaseProxy* proxy) {
    const auto* object = static_cast<const btCollisionObject*>(proxy->m_clientObject);
    return object->getInternalType() == btCollisionObject::CO_SOFT_BODY;
  };
  return is_soft(pair.m_pProxy0) || is_soft(pair.m_pProxy1);
}

btManifoldArray manifolds_of(const btBroadphasePair& pair) {
  btManifoldArray manifolds;
  // Bullet's algorithm of two soft bodies returns a pointer that it never sets.
  if (pair.m_algorithm && !is_of_soft(pair)) pair.m_algorithm->getAllContactManifolds(manifolds);
  return manifolds;
}

bool fit_algorithm(const PairState::Pair& saved, const std::vector<const PairState::Manifold*>& manifolds,
                   btBroadphasePair& pair, btCollisionWorld& world, btScalar dt) {
  if (is_of_soft(pair)) return true;
  if (saved.has_algorithm && pair.m_algorithm && has_manifolds(manifolds, pair)) return true;
  for (const btScalar before : {dt, btScalar(0)}) {
    world.getPairCache()->cleanOverlappingPair(pair, world.getDispatcher());
    if (!saved.has_algorithm) return true;
    make_algorithm(pair, world, before);
    if (has_manifolds(manifolds, pair)) return true;
  }
  return false;
}

void apply_manifold(const PairState::Manifold& saved, btPersistentManifold& manifold,
                    const btBroadphasePair& pair) {
  const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  manifold.clearManifold();
  saved.is_swapped ? manifold.setBodies(b, a) : manifold.setBodies(a, b);
  manifold.setContactBreakingThreshold(saved.breaking_threshold);
  manifold.setContactProcessingThreshold(saved.processing_threshold);
  manifold.setNumContacts(static_cast<int>(saved.points.size()));
  for (std::size_t i = 0; i < saved.points.size(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(static_cast<int>(i));
    each_point_field([](auto& to, const auto& from) { to = from; }, point, saved.points[i]);
    point.m_userPersistentData = nullptr;
  }
}

void sort_manifolds(const std::vector<btPersistentManifold*>& first, btCollisionDispatcher& dispatcher) {
  const int count = dispatcher.getNumManifolds();
  if (count == 0) return;
  btPersistentManifold** all = dispatcher.getInternalManifoldPointer();
  std::vector<btPersistentManifold*> sorted = first, known = first;
  std::sort(known.begin(), known.end(), std::less<>());
  for (int i = 0; i < count; ++i)
    if (!std::binary_search(known.begin(), known.end(), all[i], std::less<>())) sorted.push_back(all[i]);
  for (int i = 0; i < count; ++i) {
    all[i] = sorted[static_cast<std::size_t>(i)];
    all[i]->m_index1a = i;
  }
}

}  // namespace oilskin::bullet
