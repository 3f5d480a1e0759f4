#include "pair_state.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <algorithm>
#include <map>

#include "bullet_archive.h"
#include "pair_algorithm.h"

namespace oilskin::bullet {

namespace {

constexpr int stage_count = btDbvtBroadphase::STAGECOUNT + 1;

const auto assign = [](auto& to, const auto& from) { to = from; };

btDbvtBroadphase& broadphase_of(btCollisionWorld& world) {
  return static_cast<btDbvtBroadphase&>(*world.getBroadphase());
}
btCollisionDispatcher& dispatcher_of(btCollisionWorld& world) {
  return static_cast<btCollisionDispatcher&>(*world.getDispatcher());
}

btDbvtProxy* proxy_of(btCollisionWorld& world, int object) {
  return static_cast<btDbvtProxy*>(world.getCollisionObjectArray()[object]->getBroadphaseHandle());
}

/// The counters of the broadphase that decide what it does next.
std::vector<int*> counters_of(btDbvtBroadphase& b) {
  return {&b.m_stageCurrent, &b.m_newpairs, &b.m_fixedleft, &b.m_pid, &b.m_cid, &b.m_gid};
}

/// Null for other worlds.
btSequentialImpulseConstraintSolver* solver_of(btCollisionWorld& world) {
  auto* dynamics = dynamic_cast<btDynamicsWorld*>(&world);
  return dynamics ? dynamic_cast<btSequentialImpulseConstraintSolver*>(dynamics->getConstraintSolver())
                  : nullptr;
}

Status check_kinds(btCollisionWorld& world) {
  if (!dynamic_cast<btDbvtBroadphase*>(world.getBroadphase()) || world.getPairCache()->hasDeferredRemoval() ||
      !dynamic_cast<btCollisionDispatcher*>(world.getDispatcher()))
    return Status::refused(
        "contacts are saved of worlds with btDbvtBroadphase and btCollisionDispatcher only");
  return Status::accepted();
}

/// The number of an object among the attached ones; −1 = it is none.
int place_of(const btCollisionObject* object, const PairState::Attached& attached) {
  const auto at = std::find(attached.begin(), attached.end(), object);
  return at == attached.end() ? -1 : static_cast<int>(at - attached.begin());
}

using PairKey = std::pair<const void*, const void*>;

PairKey key_of(const void* a, const void* b) {
  return std::less<>()(a, b) ? PairKey(a, b) : PairKey(b, a);
}

/// Empties the cache of pairs, without touching their algorithms.
std::map<PairKey, btBroadphasePair> take_out_pairs(btCollisionWorld& world) {
  btBroadphasePairArray& all = world.getPairCache()->getOverlappingPairArray();
  std::map<PairKey, btBroadphasePair> kept;
  while (all.size() > 0) {
    btBroadphasePair& last = all[all.size() - 1];
    const btBroadphasePair pair = last;
    last.m_algorithm = nullptr;
    kept.emplace(key_of(pair.m_pProxy0, pair.m_pProxy1), pair);
    world.getPairCache()->removeOverlappingPair(pair.m_pProxy0, pair.m_pProxy1, world.getDispatcher());
  }
  return kept;
}

}  // namespace

Status PairState::capture(btCollisionWorld& world, const Attached& attached) {
  if (Status s = check_kinds(world); !s.ok()) return s;
  btDbvtBroadphase& broadphase = broadphase_of(world);
  std::map<const void*, int> number;  // by proxy
  for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
    const btCollisionObject* object = world.getCollisionObjectArray()[i];
    const btDbvtProxy* proxy = proxy_of(world, i);
    if (!proxy) return Status::refused("an object of the world has no proxy in its broadphase");
    number[proxy] = i;
    objects.push_back({object->getInternalType(), place_of(object, attached), proxy->m_aabbMin,
                       proxy->m_aabbMax, proxy->m_uniqueId, proxy->stage});
  }
  const auto number_of = [&](const void* proxy) {
    const auto it = number.find(proxy);
    return it == number.end() ? std::ptrdiff_t{-1} : std::ptrdiff_t{it->second};
  };
  for (int i = 0; i < 2; ++i)
    if (Status s = bullet::capture(broadphase.m_sets[i], objects.size(), number_of, trees[i], false); !s.ok())
      return s;
  for (int i = 0; i < stage_count; ++i)
    for (const btDbvtProxy* p = broadphase.m_stageRoots[i]; p; p = p->links[1])
      stages[i].push_back(static_cast<int>(number_of(p)));
  capture_counters(world);
  const btBroadphasePairArray& all = world.getPairCache()->getOverlappingPairArray();
  for (int i = 0; i < all.size(); ++i)
    pairs.push_back({static_cast<int>(number_of(all[i].m_pProxy0)),
                     static_cast<int>(number_of(all[i].m_pProxy1)), all[i].m_algorithm && !is_of_soft(all[i]),
                     static_cast<std::uint32_t>(manifolds_of(all[i]).size())});
  capture_manifolds(world);
  return is_valid() ? Status::accepted() : Status::refused("the broadphase of the world is in disorder");
}

void PairState::capture_counters(btCollisionWorld& world) {
  btDbvtBroadphase& broadphase = broadphase_of(world);
  for (const int* counter : counters_of(broadphase)) counters.push_back(*counter);
  counters.push_back(static_cast<int>(broadphase.m_updates_call));
  counters.push_back(static_cast<int>(broadphase.m_updates_done));
  updates_ratio = broadphase.m_updates_ratio;
  needs_cleanup = broadphase.m_needcleanup;
  time_step = world.getDispatchInfo().m_timeStep;
  if (const auto* solver = solver_of(world)) seed = solver->getRandSeed();
}

void PairState::capture_manifolds(btCollisionWorld& world) {
  const btBroadphasePairArray& all = world.getPairCache()->getOverlappingPairArray();
  std::map<int, Manifold> sorted;  // by place in the dispatcher
  for (int i = 0; i < all.size(); ++i) {
    const btManifoldArray of_pair = manifolds_of(all[i]);
    for (int k = 0; k < of_pair.size(); ++k) {
      const btPersistentManifold& from = *of_pair[k];
      Manifold& to = sorted[from.m_index1a];
      to.pair = i;
      to.place = static_cast<std::uint32_t>(k);
      to.is_swapped = from.getBody0() != all[i].m_pProxy0->m_clientObject;
      to.breaking_threshold = from.getContactBreakingThreshold();
      to.processing_threshold = from.getContactProcessingThreshold();
      for (int p = 0; p < from.getNumContacts(); ++p)
        each_point_field(assign, to.points.emplace_back(), from.getContactPoint(p));
    }
  }
  for (auto& [place, manifold] : sorted) manifolds.push_back(std::move(manifold));
}

void PairState::visit(Archive& archive) {
  const auto visit_field = [&](auto& field) { bullet::visit(archive, field); };
  archive.list(objects, 40, [&](Object& o) {
    archive.values(o.type, o.attached, o.unique_id, o.stage);
    for (btVector3* x : {&o.min, &o.max}) bullet::visit(archive, *x);
  });
  for (TreeState& tree : trees) bullet::visit(archive, tree, objects.size(), false);
  for (std::vector<int>& stage : stages) archive.value(stage);
  archive.values(counters, needs_cleanup, seed);
  for (btScalar* x : {&updates_ratio, &time_step}) bullet::visit(archive, *x);
  archive.list(pairs, 13, [&](Pair& p) { archive.values(p.first, p.second, p.has_algorithm, p.manifolds); });
  archive.list(manifolds, 21, [&](Manifold& m) {
    archive.values(m.pair, m.place, m.is_swapped);
    archive.values(m.breaking_threshold, m.processing_threshold);  // may be infinite
    archive.list(m.points, 40 * sizeof(float), [&](btManifoldPoint& p) { each_point_field(visit_field, p); });
    archive.require(m.points.size() <= MANIFOLD_CACHE_SIZE, "the number of contact points");
  });
  if (archive.ok()) archive.require(is_valid(), "the state of pairs");
}

/// Each object is in one tree and one stage, and has a number of its own.
bool PairState::has_valid_objects() const {
  std::vector<int> in_trees(objects.size(), 0), in_stages(objects.size(), 0), ids;
  for (const TreeState& tree : trees)
    for (const TreeState::Node& node : tree.nodes)
      if (node.leaf >= 0) ++in_trees[static_cast<std::size_t>(node.leaf)];
  for (int stage = 0; stage < stage_count; ++stage)
    for (int i : stages[stage]) {
      if (i < 0 || static_cast<std::size_t>(i) >= objects.size()) return false;
      if (objects[static_cast<std::size_t>(i)].stage != stage) return false;
      ++in_stages[static_cast<std::size_t>(i)];
    }
  const auto are_one = [](const std::vector<int>& counts) {
    return std::all_of(counts.begin(), counts.end(), [](int n) { return n == 1; });
  };
  for (const Object& o : objects) ids.push_back(o.unique_id);
  std::sort(ids.begin(), ids.end());
  return are_one(in_trees) && are_one(in_stages) && std::adjacent_find(ids.begin(), ids.end()) == ids.end() &&
         counters.size() == 8 && counters[0] >= 0 && counters[0] < btDbvtBroadphase::STAGECOUNT &&
         counters[4] >= 0 && (ids.empty() || (ids.front() > 0 && counters[5] >= ids.back()));
}

/// Pairs and manifolds name what there is, once.
bool PairState::has_valid_pairs() const {
  const int count = static_cast<int>(objects.size());
  const auto is_object = [count](int i) { return i >= 0 && i < count; };
  std::vector<std::pair<int, int>> sorted;
  for (const Pair& p : pairs) {
    if (!is_object(p.first) || !is_object(p.second) || p.first == p.second) return false;
    sorted.emplace_back(std::min(p.first, p.second), std::max(p.first, p.second));
  }
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return false;
  std::vector<std::pair<int, std::uint32_t>> places;
  std::vector<std::uint32_t> of_pair(pairs.size(), 0);
  for (const Manifold& m : manifolds) {
    if (m.pair < 0 || m.pair >= static_cast<int>(pairs.size())) return false;
    const auto i = static_cast<std::size_t>(m.pair);
    if (m.place >= pairs[i].manifolds) return false;
    ++of_pair[i];
    places.emplace_back(m.pair, m.place);
  }
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (of_pair[i] != pairs[i].manifolds) return false;
  std::sort(places.begin(), places.end());
  return std::adjacent_find(places.begin(), places.end()) == places.end();
}

bool PairState::is_valid() const {
  return has_valid_objects() && has_valid_pairs();
}

Status PairState::check(btCollisionWorld& world, const Attached& attached) const {
  if (Status s = check_kinds(world); !s.ok()) return s;
  if (world.getNumCollisionObjects() != static_cast<int>(objects.size()))
    return Status::refused("the world has " + std::to_string(world.getNumCollisionObjects()) +
                           " objects, that of the saved state " + std::to_string(objects.size()));
  for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
    const btCollisionObject* object = world.getCollisionObjectArray()[i];
    const Object& saved = objects[static_cast<std::size_t>(i)];
    if (object->getInternalType() != saved.type || place_of(object, attached) != saved.attached ||
        !object->getBroadphaseHandle())
      return Status::refused("object " + std::to_string(i + 1) +
                             " of the world is another one than in the saved state; add the same objects in "
                             "the same order");
  }
  return Status::accepted();
}

std::size_t PairState::apply(btCollisionWorld& world) const {
  apply_pairs(world);
  const std::size_t lost = apply_manifolds(world);
  apply_broadphase(world);
  if (auto* solver = solver_of(world)) solver->setRandSeed(static_cast<unsigned long>(seed));
  return lost;
}

void PairState::apply_broadphase(btCollisionWorld& world) const {
  btDbvtBroadphase& broadphase = broadphase_of(world);
  const auto place = [&](std::size_t i) {
    btDbvtProxy* proxy = proxy_of(world, static_cast<int>(i));
    return LeafPlace{proxy, &proxy->leaf};
  };
  for (int i = 0; i < 2; ++i) bullet::apply(trees[i], broadphase.m_sets[i], place);
  for (int stage = 0; stage < stage_count; ++stage) {
    btDbvtProxy* before = nullptr;
    broadphase.m_stageRoots[stage] = nullptr;
    for (int i : stages[stage]) {
      btDbvtProxy* proxy = proxy_of(world, i);
      (before ? before->links[1] : broadphase.m_stageRoots[stage]) = proxy;
      proxy->links[0] = before;
      proxy->links[1] = nullptr;
      before = proxy;
    }
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    btDbvtProxy* proxy = proxy_of(world, static_cast<int>(i));
    proxy->m_aabbMin = objects[i].min;
    proxy->m_aabbMax = objects[i].max;
    proxy->stage = objects[i].stage;
  }
  const std::vector<int*> present = counters_of(broadphase);
  for (std::size_t i = 0; i < present.size(); ++i) *present[i] = counters[i];
  broadphase.m_updates_call = static_cast<unsigned>(counters[6]);
  broadphase.m_updates_done = static_cast<unsigned>(counters[7]);
  broadphase.m_updates_ratio = updates_ratio;
  broadphase.m_needcleanup = needs_cleanup;
  world.getDispatchInfo().m_timeStep = time_step;
}

/// The cache takes pairs out and in by itself, so that its hash table is right; algorithms are kept
/// meanwhile.
void PairState::apply_pairs(btCollisionWorld& world) const {
  btOverlappingPairCache& cache = *world.getPairCache();
  std::map<PairKey, btBroadphasePair> kept = take_out_pairs(world);
  for (std::size_t i = 0; i < objects.size(); ++i)
    proxy_of(world, static_cast<int>(i))->m_uniqueId = objects[i].unique_id;
  for (const Pair& saved : pairs) {
    btDbvtProxy *a = proxy_of(world, saved.first), *b = proxy_of(world, saved.second);
    btBroadphasePair* pair = cache.addOverlappingPair(a, b);
    const auto it = kept.find(key_of(a, b));
    // An algorithm knows which of the objects is the first one.
    if (pair && it != kept.end() && it->second.m_pProxy0 == pair->m_pProxy0)
      std::swap(pair->m_algorithm, it->second.m_algorithm);
  }
  for (auto& [proxies, pair] : kept) cache.cleanOverlappingPair(pair, world.getDispatcher());
}

std::size_t PairState::apply_manifolds(btCollisionWorld& world) const {
  std::size_t lost = 0;
  std::vector<std::vector<const Manifold*>> of_pair(pairs.size());
  for (const Manifold& m : manifolds) of_pair[static_cast<std::size_t>(m.pair)].push_back(&m);
  std::vector<btBroadphasePair*> present;  // null where its manifolds are not the saved ones
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    btBroadphasePair* pair =
        world.getPairCache()->findPair(proxy_of(world, pairs[i].first), proxy_of(world, pairs[i].second));
    const bool fits = pair && fit_algorithm(pairs[i], of_pair[i], *pair, world, time_step);
    present.push_back(fits ? pair : nullptr);
    lost += !fits;
  }
  std::vector<btPersistentManifold*> order;
  for (const Manifold& saved : manifolds) {
    const btBroadphasePair* pair = present[static_cast<std::size_t>(saved.pair)];
    if (!pair) continue;
    btManifoldArray here = manifolds_of(*pair);
    if (static_cast<int>(saved.place) >= here.size()) continue;
    order.push_back(here[static_cast<int>(saved.place)]);
    apply_manifold(saved, *order.back(), *pair);
  }
  sort_manifolds(order, dispatcher_of(world));
  return lost;
}

}  // namespace oilskin::bullet
