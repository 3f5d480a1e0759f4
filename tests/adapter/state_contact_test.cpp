// A saved state with a world has the contacts of its rigid bodies: piles go on as after the save.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/frame.h"
#include "state_scene.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr FrameKind saved_state = {{'O', 'I', 'L', 'S', 'T', 'A', 'T', 'E'}, 5, "saved state"};

/// Boxes, balls and compounds that fall on a floor of triangles and a cloth, with some water.
struct Pile {
  btFluidSoftBodySolver solver;
  SoftWorld bullet{btVector3(0, bt(-9.81), 0), &solver};
  btFluid water;
  btTriangleMesh mesh;
  std::unique_ptr<btBvhTriangleMeshShape> floor_shape;
  btBoxShape box{btVector3(bt(0.05), bt(0.04), bt(0.05))};
  btSphereShape ball{bt(0.04)};
  btCompoundShape pair;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  btSoftBody* cloth = nullptr;

  explicit Pile(int threads = 1, bool has_compounds = false)
      : water(coarse_fluid(), with_threads(threads), ContactSettings{}) {
    const btVector3 a(-1, 0, -1), b(1, 0, -1), c(1, 0, 1), d(-1, bt(0.05), 1);
    mesh.addTriangle(a, c, b);
    mesh.addTriangle(a, d, c);
    floor_shape = std::make_unique<btBvhTriangleMeshShape>(&mesh, true);
    pair.addChildShape(at(-0.03, 0, 0), &ball);
    pair.addChildShape(at(0.04, 0, 0), &box);
    EXPECT_TRUE(solver.addFluid(&water).ok());
    add(floor_shape.get(), 0, at(0, 0, 0));
    btCollisionShape* shapes[] = {&box, &ball, has_compounds ? static_cast<btCollisionShape*>(&pair) : &box};
    for (int i = 0; i < 8; ++i)
      add(shapes[i % 3], 0.5, at(0.02 * (i % 2) + 0.01 * (i % 4), 0.1 + 0.11 * i, 0.015 * (i % 3)));
    cloth = bullet.patch(9, 0.3, 0.4);
    EXPECT_TRUE(solver.addCloth(cloth, bt(0.004)).ok());
    EXPECT_TRUE(water.addBox({bt(-0.3), bt(0.2), bt(-0.3)}, {bt(-0.2), bt(0.3), bt(-0.2)}).ok());
  }
  ~Pile() {
    for (auto& body : bodies) bullet.world.removeRigidBody(body.get());
    solver.removeFluid(&water);
  }
  void add(btCollisionShape* shape, double mass, const btTransform& transform) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(bt(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(bt(mass), nullptr, shape, inertia);
    info.m_startWorldTransform = transform;
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bullet.world.addRigidBody(bodies.back().get());
    EXPECT_TRUE(solver.addRigidBody(bodies.back().get(), bt(0.004)).ok());
  }
  std::vector<btScalar> run(int steps) {
    for (int i = 0; i < steps; ++i) bullet.step(1.0 / 240);
    std::vector<btScalar> seen;
    const auto see = [&](const btVector3& v) { seen.insert(seen.end(), v.m_floats, v.m_floats + 3); };
    for (const auto& body : bodies)
      see(body->getWorldTransform().getOrigin()), see(body->getAngularVelocity());
    for (int i = 0; i < cloth->m_nodes.size(); ++i) see(cloth->m_nodes[i].m_x);
    for (std::size_t i = 0; i < water.getWorld().particle_count(); ++i)
      see(to_bt(water.getWorld().positions()[i]));
    return seen;
  }
  Bytes save() {
    Bytes bytes;
    const Status status = solver.saveState(&bytes, &bullet.world);
    EXPECT_TRUE(status.ok()) << status.message;
    return bytes;
  }
  Status restore(const Bytes& bytes) { return solver.restoreState(bytes, &bullet.world); }
};

/// While it collides, and near rest.
TEST(ContactState, a_pile_goes_back_and_on) {
  for (const int steps : {100, 200}) {
    Pile pile;
    pile.run(steps);
    const Bytes saved = pile.save();
    const std::vector<btScalar> right = pile.run(50);
    ASSERT_TRUE(pile.restore(saved).ok());
    for (auto& body : pile.bodies) body->activate(), body->applyCentralImpulse({0, 1, 0});
    EXPECT_FALSE(pile.run(80) == right);
    ASSERT_TRUE(pile.restore(saved).ok());
    ASSERT_TRUE(pile.save() == saved);
    ASSERT_TRUE(pile.run(50) == right) << steps;
    EXPECT_EQ(testing::PrintToString(pile.solver.takeMessages()), "{}");
    Pile fresh(2);
    ASSERT_TRUE(fresh.restore(saved).ok());
    EXPECT_TRUE(fresh.save() == saved);
    EXPECT_TRUE(fresh.run(50) == right) << steps;
  }
}

/// Whatever the memory held before that Bullet takes for the algorithm of a pair.
void dirty_memory_of_algorithms(btDispatcher& dispatcher) {
  constexpr int size = 64;
  std::vector<void*> taken(64);
  for (void*& memory : taken) std::memset(memory = dispatcher.allocateCollisionAlgorithm(size), 0x40, size);
  for (void* memory : taken) dispatcher.freeCollisionAlgorithm(memory);
}

TEST(ContactState, soft_bodies_that_overlap_go_back_and_on) {
  btFluidSoftBodySolver solver;
  SoftWorld bullet{btVector3(0, bt(-9.81), 0), &solver};
  dirty_memory_of_algorithms(*bullet.world.getDispatcher());
  for (const double y : {0.1, 0.105})
    ASSERT_TRUE(solver.addCloth(bullet.patch(7, 0.3, y, 15), bt(0.004)).ok());
  bullet.step(1.0 / 240);
  ASSERT_EQ(bullet.world.getPairCache()->getNumOverlappingPairs(), 1);
  Bytes saved, again;
  ASSERT_TRUE(solver.saveState(&saved, &bullet.world).ok());
  for (int i = 0; i < 5; ++i) bullet.step(1.0 / 240);
  ASSERT_TRUE(solver.restoreState(saved, &bullet.world).ok());
  ASSERT_TRUE(solver.saveState(&again, &bullet.world).ok());
  EXPECT_TRUE(again == saved);
}

/// Bullet keeps parts of compounds that touched before; they cannot always be made again.
TEST(ContactState, a_pile_of_compounds_goes_on_or_says_that_it_differs) {
  Pile pile(1, true);
  pile.run(150);
  const Bytes saved = pile.save();
  const std::vector<btScalar> right = pile.run(20);
  ASSERT_TRUE(pile.restore(saved).ok());
  const std::vector<std::string> messages = pile.solver.takeMessages();
  const std::vector<btScalar> again = pile.run(20);
  ASSERT_EQ(again.size(), right.size());
  if (messages.empty()) {
    EXPECT_TRUE(again == right);
  } else {
    EXPECT_TRUE(has(messages[0], "pairs could not be restored, and Bullet finds them anew"));
  }
}

TEST(ContactState, without_the_world_a_pile_goes_on_a_little_differently) {
  Pile pile;
  pile.run(130);
  Bytes saved;
  ASSERT_TRUE(pile.solver.saveState(&saved).ok());
  const std::vector<btScalar> right = pile.run(30);
  ASSERT_TRUE(pile.solver.restoreState(saved).ok());
  EXPECT_NE(pile.run(30), right);
}

TEST(ContactState, of_another_world_is_refused) {
  Pile pile, here;
  pile.run(130);
  here.run(90);
  const Bytes saved = pile.save(), before = here.save();
  const auto refusal = [&](Span<const std::uint8_t> bytes, btCollisionWorld* world) {
    const std::string why = here.solver.restoreState(bytes, world).message;
    EXPECT_NE(why, "");
    EXPECT_TRUE(here.save() == before);
    return why;
  };
  EXPECT_TRUE(has(refusal(saved, nullptr), "the contacts of a world: give the world"));
  Bytes plain;
  ASSERT_TRUE(pile.solver.saveState(&plain).ok());
  EXPECT_TRUE(has(refusal(plain, &here.bullet.world), "no contacts of a world"));
  btCollisionObject extra;
  extra.setCollisionShape(&here.ball);
  here.bullet.world.addCollisionObject(&extra);
  EXPECT_TRUE(has(here.restore(saved).message, "the world has 11 objects, that of the saved state 10"));
  here.bullet.world.removeCollisionObject(&extra);
  here.bullet.world.removeRigidBody(here.bodies[3].get());
  here.bullet.world.addRigidBody(here.bodies[3].get());
  EXPECT_TRUE(
      has(here.restore(saved).message, "object 4 of the world is another one than in the saved state"));

  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btSimpleBroadphase simple;
  btCollisionWorld other(&dispatcher, &simple, &configuration);
  Bytes out = {5};
  EXPECT_TRUE(
      has(pile.solver.saveState(&out, &other).message, "btDbvtBroadphase and btCollisionDispatcher only"));
  EXPECT_EQ(out, Bytes{5});
}

TEST(ContactState, changed_content_is_refused_or_goes_on) {
  Pile pile;
  pile.run(90);
  const Bytes before = pile.save();
  Span<const std::uint8_t> inside;
  ASSERT_TRUE(unframe(saved_state, before, &inside).ok());
  int accepted = 0, refused = 0;
  // What is kept of pairs is at the end.
  for (std::size_t from_end = 1; from_end < 6000; from_end += 53) {
    Bytes changed(inside.begin(), inside.end());
    const std::size_t first = changed.size() - from_end;
    for (std::size_t k = first; k < std::min(first + 3, changed.size()); ++k) changed[k] ^= 0x55;
    const Status status = pile.restore(framed(saved_state, changed));
    status.ok() ? ++accepted : ++refused;
    if (status.ok()) {
      pile.bullet.step(1.0 / 240);
      ASSERT_TRUE(pile.restore(before).ok());
    }
    ASSERT_TRUE(pile.save() == before) << from_end;
    const Bytes cut(changed.begin(), changed.begin() + static_cast<std::ptrdiff_t>(first));
    ASSERT_FALSE(pile.restore(framed(saved_state, cut)).ok());
  }
  EXPECT_GT(accepted, 5);
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace oilskin::bullet
