// Objects that the owner deletes, shares or mistakes.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <new>

#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet {
namespace {

using namespace test;

const btVector3 down(0, bt(-9.81), 0);

/// A world whose soft-body solver couples a fluid.
struct Game {
  btFluidSoftBodySolver solver;
  SoftWorld bullet{down, &solver};
  btFluid water{coarse_fluid(), small_world(), verified()};

  Game() { EXPECT_TRUE(solver.addFluid(&water).ok()); }

  Status pour() { return water.addBox({bt(-0.08), bt(0.03), bt(-0.08)}, {bt(0.08), bt(0.11), bt(0.08)}); }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) bullet.step(0.001);
  }
  std::string messages() {
    std::string all;
    for (const std::string& message : solver.takeMessages()) all += message + "\n";
    return all;
  }
};

double lowest(const btFluid& water) {
  double y = 1;
  for (int i = 0; i < water.getNumParticles(); ++i)
    y = std::min(y, static_cast<double>(water.getPosition(i).y()));
  return y;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

TEST(Ownership, a_cloth_that_is_deleted_wet_without_a_word_to_the_solver_is_detached) {
  Game game;
  btSoftBody* cloth = game.bullet.patch(11, 0.4, 0, 15);
  ASSERT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(120);
  ASSERT_GT(game.water.getNumParticles(), 100);
  EXPECT_FALSE(has(game.messages(), "detached"));
  const double held = lowest(game.water);
  game.bullet.destroy(cloth);
  game.run(200);
  EXPECT_TRUE(has(game.messages(), "a cloth was detached"));
  EXPECT_EQ(game.water.getWorld().surface_count(), 0u);
  EXPECT_EQ(game.solver.getCoupling().getSurfaceId(cloth).value, 0u);
  EXPECT_LT(lowest(game.water), held - 0.1) << "no invisible sheet holds the water";
  game.run(1);
  EXPECT_FALSE(has(game.messages(), "detached")) << "told once";
}

TEST(Ownership, other_cloth_stays_attached_when_one_is_deleted) {
  Game game;
  btSoftBody* upper = game.bullet.patch(5, 0.4, 0.3, 15);
  btSoftBody* lower = game.bullet.patch(11, 0.4, 0, 15);
  ASSERT_TRUE(game.solver.addCloth(upper, bt(0.002)).ok());
  ASSERT_TRUE(game.solver.addCloth(lower, bt(0.002)).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(2);
  game.bullet.destroy(upper);
  game.run(120);
  EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
  EXPECT_GT(lowest(game.water), -0.1);
  EXPECT_EQ(game.solver.getReport().contact.crossings_found_by_verify, 0u);
}

/// Objects at one address, one after the other.
template <class Body>
class SameAddress {
 public:
  template <class... Args>
  Body* make(Args&&... args) {
    drop();
    return body_ = new (storage_) Body(std::forward<Args>(args)...);
  }
  void drop() {
    if (body_) body_->~Body();
    body_ = nullptr;
  }
  ~SameAddress() { drop(); }

 private:
  alignas(64) unsigned char storage_[sizeof(Body)];
  Body* body_ = nullptr;
};

TEST(Ownership, a_new_cloth_at_the_address_of_a_deleted_one_is_not_attached) {
  Game game;
  SameAddress<btSoftBody> place;
  const btVector3 nodes[] = {{bt(-0.2), 0, bt(-0.2)}, {bt(0.2), 0, bt(-0.2)}, {0, 0, bt(0.2)}};
  const btScalar masses[] = {0, 0, 0};
  auto make = [&] {
    btSoftBody* cloth = place.make(&game.bullet.world.getWorldInfo(), 3, nodes, masses);
    cloth->appendFace(0, 1, 2);
    return cloth;
  };
  btSoftBody* first = make();
  game.bullet.world.addSoftBody(first);
  ASSERT_TRUE(game.solver.addCloth(first, bt(0.002)).ok());
  game.run(2);
  EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
  game.bullet.world.removeSoftBody(first);
  btSoftBody* second = make();
  ASSERT_EQ(second, first);
  game.bullet.world.addSoftBody(second);
  game.run(1);
  EXPECT_EQ(game.water.getWorld().surface_count(), 0u);
  EXPECT_TRUE(has(game.messages(), "detached"));
  ASSERT_TRUE(game.solver.addCloth(second, bt(0.002)).ok());
  game.run(1);
  EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
  game.bullet.world.removeSoftBody(second);
}

TEST(Ownership, a_new_cloth_is_attached_at_once_where_a_deleted_one_was) {
  Game game;
  SameAddress<btSoftBody> place;
  const btVector3 nodes[] = {{bt(-0.2), 0, bt(-0.2)}, {bt(0.2), 0, bt(-0.2)}, {0, 0, bt(0.2)}};
  const btScalar masses[] = {0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    btSoftBody* cloth = place.make(&game.bullet.world.getWorldInfo(), 3, nodes, masses);
    cloth->appendFace(0, 1, 2);
    game.bullet.world.addSoftBody(cloth);
    const Status status = game.solver.addCloth(cloth, bt(0.002));
    ASSERT_TRUE(status.ok()) << status.message;
    game.run(1);
    EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
    game.bullet.world.removeSoftBody(cloth);
  }
}

TEST(Ownership, a_rigid_body_deleted_from_the_given_world_is_detached) {
  Game game;
  game.solver.setCollisionWorld(&game.bullet.world);
  btBoxShape shape({bt(0.2), bt(0.02), bt(0.2)});
  auto body = std::make_unique<btRigidBody>(bt(0), nullptr, &shape);
  game.bullet.world.addRigidBody(body.get());
  ASSERT_TRUE(game.solver.addCollisionObject(body.get(), bt(0.002)).ok());
  ASSERT_TRUE(game.pour().ok());
  game.run(100);
  EXPECT_EQ(game.water.getWorld().surface_count(), 1u);
  const double held = lowest(game.water);
  EXPECT_GT(held, 0);
  game.bullet.world.removeRigidBody(body.get());
  body.reset();
  game.run(200);
  EXPECT_EQ(game.water.getWorld().surface_count(), 0u);
  EXPECT_TRUE(has(game.messages(), "a collision object was detached"));
  EXPECT_LT(lowest(game.water), held - 0.1);
}

TEST(Ownership, step_by_hand_detaches_with_the_world_given) {
  SoftWorld bullet(down);
  btFluid water(coarse_fluid(), small_world(), verified());
  btFluidCoupling coupling(&water);
  coupling.setCollisionWorld(&bullet.world);
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 15);
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  bullet.step(0.001);
  ASSERT_TRUE(coupling.step(bt(0.001)).status.ok());
  EXPECT_EQ(water.getWorld().surface_count(), 1u);
  bullet.destroy(cloth);
  ASSERT_TRUE(coupling.step(bt(0.001)).status.ok());
  EXPECT_EQ(water.getWorld().surface_count(), 0u);
}

TEST(Ownership, a_cloth_in_another_coupling_is_refused_and_a_wall_is_shared) {
  SoftWorld bullet(down);
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 15);
  btBoxShape shape({bt(0.2), bt(0.02), bt(0.2)});
  btCollisionObject wall;
  wall.setCollisionShape(&shape);
  btFluid water(coarse_fluid(), small_world(), verified()), oil(coarse_fluid(), small_world(), verified());
  auto first = std::make_unique<btFluidCoupling>(&water);
  btFluidCoupling second(&oil);
  ASSERT_TRUE(first->addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(first->addCollisionObject(&wall, bt(0.002)).ok());
  const Status status = second.addCloth(cloth, bt(0.002));
  ASSERT_FALSE(status.ok());
  EXPECT_TRUE(has(status.message, "another coupling")) << status.message;
  EXPECT_TRUE(second.addCollisionObject(&wall, bt(0.002)).ok());
  first->removeCloth(cloth);
  EXPECT_TRUE(second.addCloth(cloth, bt(0.002)).ok());
  first.reset();
  second.removeCollisionObject(&wall);
  EXPECT_TRUE(second.addCollisionObject(&wall, bt(0.002)).ok());
}

TEST(Ownership, a_coupling_deleted_before_its_cloth_leaves_it_free_for_the_next) {
  SoftWorld bullet(down);
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 15);
  for (int i = 0; i < 2; ++i) {
    btFluid water(coarse_fluid(), small_world(), verified());
    btFluidCoupling coupling(&water);
    const Status status = coupling.addCloth(cloth, bt(0.002));
    EXPECT_TRUE(status.ok()) << status.message;
    EXPECT_TRUE(coupling.step(bt(0.001)).status.ok());
  }
}

TEST(Ownership, an_extension_pointer_of_another_library_stays) {
  SoftWorld bullet(down);
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 15);
  int theirs = 0;
  cloth->internalSetExtensionPointer(&theirs);
  btFluid water(coarse_fluid(), small_world(), verified());
  btFluidCoupling coupling(&water);
  coupling.setCollisionWorld(&bullet.world);
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(coupling.step(bt(0.001)).status.ok());
  EXPECT_EQ(water.getWorld().surface_count(), 1u);
  coupling.removeCloth(cloth);
  EXPECT_EQ(cloth->internalGetExtensionPointer(), &theirs);
}

TEST(Mistakes, gravity_that_is_overwritten_is_told) {
  Game game;
  btSoftBody* cloth = game.bullet.patch(5, 0.4, 0, 15);
  ASSERT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
  game.run(2);
  EXPECT_EQ(game.messages(), "");
  ASSERT_TRUE(game.water.getWorld().set_gravity(Vec3(0, -50, 0)).ok());
  game.run(1);
  EXPECT_TRUE(has(game.messages(), "setUseClothGravity(false)"));
  game.run(2);
  EXPECT_EQ(game.messages(), "");
}

TEST(Messages, that_differ_in_numbers_alone_are_one) {
  FluidSettings honey = coarse_fluid();
  honey.viscosity = 0.5;
  honey.max_substeps = 1;
  btFluidCoupling coupling;
  btFluid water{honey, small_world(), ContactSettings()};
  ASSERT_TRUE(coupling.addFluid(&water).ok());
  ASSERT_TRUE(water.addBox({bt(-0.05), bt(0.03), bt(-0.05)}, {bt(0.05), bt(0.08), bt(0.05)}).ok());
  for (const double dt : {0.001, 0.0015, 0.0021}) coupling.step(bt(dt));
  const std::vector<std::string> messages = coupling.takeMessages();
  const auto of_viscosity = [](const std::string& m) { return has(m, "fluid.viscosity"); };
  ASSERT_EQ(std::count_if(messages.begin(), messages.end(), of_viscosity), 1);
  EXPECT_TRUE(has(*std::find_if(messages.begin(), messages.end(), of_viscosity), "at dt 0.0021 s"))
      << "the last";
}

TEST(Messages, about_several_surfaces_are_several) {
  Game game;
  btSoftBody* cloths[] = {game.bullet.patch(5, 0.4, 0, 15), game.bullet.patch(5, 0.4, bt(0.1), 15)};
  for (btSoftBody* cloth : cloths) ASSERT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
  game.run(1);
  for (btSoftBody* cloth : cloths) game.bullet.world.removeSoftBody(cloth);
  game.run(1);
  const std::string messages = game.messages();
  EXPECT_TRUE(has(messages, "(surface 1)") && has(messages, "(surface 2)")) << messages;
}

TEST(Mistakes, two_drivers_of_one_fluid_are_told) {
  Game game;
  game.run(2);
  game.solver.getCoupling().step(bt(0.001));
  EXPECT_TRUE(has(game.messages(), "step() was called, too"));
}

TEST(Mistakes, millimetres_for_metres_are_refused) {
  Game game;
  btSoftBody* cloth = game.bullet.patch(5, 0.4, 0, 15);
  for (const double thickness : {2.0, 100.0}) {
    const Status status = game.solver.addCloth(cloth, bt(thickness));
    ASSERT_FALSE(status.ok());
    EXPECT_TRUE(has(status.message, "metres")) << status.message;
  }
  EXPECT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
}

TEST(Mistakes, places_out_of_range_are_zero) {
  Game game;
  ASSERT_TRUE(game.pour().ok());
  game.run(1);
  const int n = game.water.getNumParticles();
  ASSERT_GT(n, 100);
  for (const int i : {-1, n, n + 1000000000}) {
    EXPECT_EQ(game.water.getPosition(i), btVector3(0, 0, 0));
    EXPECT_EQ(game.water.getVelocity(i), btVector3(0, 0, 0));
    EXPECT_EQ(game.water.getId(i), std::numeric_limits<std::uint64_t>::max());
  }
  game.water.copyPositions(nullptr);
  game.water.copyVelocities(nullptr);
  float out[3] = {7, 7, 7};
  game.water.copyPositions(out, 4);
  EXPECT_EQ(out[0], 7);
  EXPECT_FALSE(game.water.getWorld().save(nullptr).ok());
}

}  // namespace
}  // namespace oilskin::bullet
