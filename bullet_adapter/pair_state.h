/// What a world of Bullet's keeps of pairs of objects: broadphase, contact points, the order of both.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include "tree_state.h"

namespace oilskin::bullet {

/// Objects are numbered in the order in which their world has them.
struct PairState {
  struct Object {
    int type = 0;        ///< btCollisionObject::getInternalType()
    int attached = -1;   ///< its number among the attached objects; −1 = it is none
    btVector3 min, max;  ///< [m]
    int unique_id = 0;   ///< of its proxy
    int stage = 0;
  };
  struct Pair {
    int first = 0, second = 0;
    bool has_algorithm = false;
    std::uint32_t manifolds = 0;  ///< of the algorithm
  };
  struct Manifold {
    int pair = 0;
    std::uint32_t place = 0;  ///< among those of the pair
    bool is_swapped = false;  ///< its first body is the second one of the pair
    btScalar breaking_threshold = 0, processing_threshold = 0;
    std::vector<btManifoldPoint> points;
  };
  std::vector<Object> objects;
  TreeState trees[2];
  std::vector<int> stages[3];  ///< numbers of objects
  std::vector<int> counters;
  btScalar updates_ratio = 0;
  btScalar time_step = 0;  ///< of the last step [s]
  bool needs_cleanup = false;
  std::vector<Pair> pairs;
  std::vector<Manifold> manifolds;
  std::uint64_t seed = 0;

  using Attached = std::vector<const btCollisionObject*>;

  /// Refuses worlds without btDbvtBroadphase, a hashed cache of pairs and btCollisionDispatcher.
  Status capture(btCollisionWorld& world, const Attached& attached);
  void visit(Archive& archive);
  /// Refuses a world with other objects.
  Status check(btCollisionWorld& world, const Attached& attached) const;
  /// The number of pairs whose contacts could not be given back, and were cleared.
  std::size_t apply(btCollisionWorld& world) const;

 private:
  void capture_counters(btCollisionWorld& world);
  void capture_manifolds(btCollisionWorld& world);
  void apply_broadphase(btCollisionWorld& world) const;
  void apply_pairs(btCollisionWorld& world) const;
  std::size_t apply_manifolds(btCollisionWorld& world) const;
  bool is_valid() const;
  bool has_valid_objects() const;
  bool has_valid_pairs() const;
};

}  // namespace oilskin::bullet
