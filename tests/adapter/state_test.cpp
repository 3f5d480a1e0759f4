// A game saves its whole state, goes on, and goes back: what follows is the same to the bit.
#include <gtest/gtest.h>

#include "oilskin/bullet_force.h"
#include "oilskin/bullet_sink.h"
#include "state_scene.h"

namespace oilskin::bullet {
namespace {

using namespace test;

class State : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, State, testing::Values(1, 2));

StateOptions with(int threads) {
  StateOptions options;
  options.threads = threads;
  return options;
}

/// Of each of ten pieces of play after a save.
std::vector<std::string> replay(StateScene& scene, double input) {
  std::vector<std::string> seen;
  for (int i = 0; i < 10; ++i) {
    scene.play(6, input);
    seen.push_back(scene.look());
  }
  return seen;
}

TEST_P(State, a_game_goes_back_and_on) {
  StateScene scene(with(GetParam()));
  EXPECT_TRUE(scene.pour(0.01).ok());
  scene.play(100, 0.5);
  const Bytes saved = scene.save();
  const std::string before = scene.look();
  scene.ear.heard.str("");
  const std::vector<std::string> right = replay(scene, -1);
  const std::string heard = scene.ear.heard.str();
  const double moved = double(scene.motion_state.m_graphicsWorldTrans.getOrigin().y());

  for (const double wrong_input : {2.0, -3.0}) {
    ASSERT_TRUE(scene.solver.restoreState(saved).ok());
    ASSERT_EQ(scene.look(), before);
    EXPECT_NE(replay(scene, wrong_input).back(), right.back());
    const Status status = scene.solver.restoreState(saved);
    ASSERT_TRUE(status.ok()) << status.message;
    ASSERT_EQ(scene.look(), before);
    ASSERT_EQ(scene.save(), saved);
    scene.ear.heard.str("");
    ASSERT_EQ(replay(scene, -1), right);
    EXPECT_EQ(scene.ear.heard.str(), heard);
    EXPECT_EQ(double(scene.motion_state.m_graphicsWorldTrans.getOrigin().y()), moved);
  }
  EXPECT_NE(heard.find("splash 3"), std::string::npos) << "the box was not hit";
  EXPECT_NE(heard.find("splash 2"), std::string::npos) << "the cloth was not hit";
  EXPECT_NE(heard.find("entered 4"), std::string::npos) << "the sensor saw nothing";
}

TEST_P(State, another_coupling_built_the_same_way_goes_on) {
  StateScene scene(with(GetParam()));
  EXPECT_TRUE(scene.pour(0.01).ok());
  scene.play(100, 0.5);
  const Bytes saved = scene.save();
  const std::vector<std::string> right = replay(scene, 1);

  StateScene fresh(with(3 - GetParam()));
  Status status = fresh.solver.restoreState(saved);
  ASSERT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(fresh.save(), saved);
  EXPECT_EQ(replay(fresh, 1), right);
}

TEST(State, what_was_not_taken_yet_is_there_again) {
  StateScene scene;
  EXPECT_TRUE(scene.pour(0.01).ok());
  scene.play(60, 0);
  const Bytes saved = scene.save();
  btFluidCoupling& coupling = scene.solver.getCoupling();
  btVector3 impulse, moment, again, moment_again;
  ASSERT_TRUE(coupling.takeImpulse(scene.box.get(), impulse, moment));
  const StepReport sum = coupling.takeReport();
  ASSERT_GT(impulse.length(), 0);
  EXPECT_TRUE(coupling.setTouchHold(7).ok());
  coupling.setCarriesWater(false);

  ASSERT_TRUE(coupling.restoreState(saved).ok());
  ASSERT_TRUE(coupling.takeImpulse(scene.box.get(), again, moment_again));
  EXPECT_EQ(to_vec3(again), to_vec3(impulse));
  EXPECT_EQ(to_vec3(moment_again), to_vec3(moment));
  const StepReport sum_again = coupling.takeReport();
  EXPECT_EQ(sum_again.dt, sum.dt);
  EXPECT_EQ(sum_again.emitted, sum.emitted);
  EXPECT_EQ(sum_again.contact.candidates, sum.contact.candidates);
  EXPECT_EQ(sum_again.energy.made, sum.energy.made);
  EXPECT_EQ(coupling.getTouchHold(), bt(0.1));
  EXPECT_TRUE(coupling.getCarriesWater());
}

TEST(State, sinks_and_forces_that_were_added_again_are_the_saved_ones) {
  StateScene scene;
  EXPECT_TRUE(scene.pour(0.01).ok());
  btBoxShape shape({bt(0.2), bt(0.02), bt(0.2)});
  btFluidSink sink(&shape);
  btFluidUniformForce wind({1, 0, 0});
  EXPECT_TRUE(sink.setWorldTransform(at(0, 0.01, 0)).ok());
  EXPECT_TRUE(scene.water.addSink(&sink).ok());
  EXPECT_TRUE(scene.water.addForce(&wind).ok());
  scene.play(40, 0);
  const std::uint64_t taken = sink.getTakenParticles();
  ASSERT_GT(taken, 10u);
  const Bytes saved = scene.save();
  const std::vector<std::string> right = replay(scene, 1);
  EXPECT_GT(sink.getTakenParticles(), taken);

  scene.water.removeSink(&sink);
  scene.water.removeForce(&wind);
  EXPECT_TRUE(has(scene.solver.restoreState(saved).message, "the saved state has 1 sinks, the coupling 0"));
  EXPECT_TRUE(scene.water.addSink(&sink).ok());
  EXPECT_TRUE(has(scene.solver.restoreState(saved).message, "the saved state has 1 forces, the coupling 0"));
  btFluidVortex vortex({0, 0, 0}, {0, 1, 0}, 1, 1);
  EXPECT_TRUE(scene.water.addForce(&vortex).ok());
  EXPECT_TRUE(has(scene.solver.restoreState(saved).message, "force 1 is of another kind"));
  scene.water.removeForce(&vortex);
  EXPECT_TRUE(scene.water.addForce(&wind).ok());
  EXPECT_TRUE(wind.setAcceleration({0, 0, 9}).ok());
  EXPECT_TRUE(sink.setWorldTransform(at(0, 5, 0)).ok());
  const Status status = scene.solver.restoreState(saved);
  ASSERT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(sink.getTakenParticles(), taken);
  EXPECT_EQ(to_vec3(wind.getAcceleration()), Vec3(1, 0, 0));
  EXPECT_EQ(replay(scene, 1), right);
}

TEST(State, a_state_between_two_couplings_goes_on) {
  StateScene scene, fresh;
  for (StateScene* s : {&scene, &fresh}) s->solver.setCouplingInterval(3);
  scene.play(25, 1);  // one sub-step after a coupling
  ASSERT_TRUE(fresh.solver.restoreState(scene.save()).ok());
  for (int i = 0; i < 4; ++i) {
    scene.play(1, 1);
    fresh.play(1, 1);
    ASSERT_EQ(scene.look(), fresh.look()) << i;
  }
}

/// Cloths that fall on each other and on boxes, which Bullet finds through its trees.
struct Heap {
  btFluidSoftBodySolver solver;
  SoftWorld bullet{btVector3(0, bt(-9.81), 0), &solver};
  btBoxShape shape{btVector3(bt(0.05), bt(0.05), bt(0.05))};
  btCollisionObject boxes[2];
  std::vector<btSoftBody*> cloths;

  Heap() {
    for (int i = 0; i < 2; ++i) {
      boxes[i].setCollisionShape(&shape);
      boxes[i].setWorldTransform(
          btTransform(btQuaternion({0, 1, 0}, bt(0.3)), {bt(0.12 * i - 0.06), bt(-0.08), 0}));
      bullet.world.addCollisionObject(&boxes[i]);
    }
    for (int i = 0; i < 2; ++i) {
      cloths.push_back(bullet.patch(14 + 3 * i, 0.3, 0.03 * i));
      cloths.back()->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
      cloths.back()->setPose(false, true);
      cloths.back()->m_cfg.kMT = bt(0.01);
      EXPECT_TRUE(solver.addCloth(cloths.back(), bt(0.004)).ok());
    }
  }
  ~Heap() {
    for (btCollisionObject& box : boxes) bullet.world.removeCollisionObject(&box);
  }
  std::vector<btScalar> run(int steps) {
    for (int i = 0; i < steps; ++i) bullet.step(0.002);
    std::vector<btScalar> seen;
    for (const btSoftBody* cloth : cloths)
      for (int i = 0; i < cloth->m_nodes.size(); ++i)
        for (int k = 0; k < 3; ++k) seen.push_back(cloth->m_nodes[i].m_x[k]);
    return seen;
  }
};

TEST(State, cloth_on_boxes_and_cloth_finds_its_contacts_in_the_same_order) {
  Heap heap;
  heap.run(100);
  Bytes saved;
  Status status = heap.solver.saveState(&saved);
  ASSERT_TRUE(status.ok()) << status.message;
  ASSERT_GT(heap.cloths[0]->m_rcontacts.size(), 5);
  ASSERT_GT(heap.cloths[0]->m_scontacts.size() + heap.cloths[1]->m_scontacts.size(), 5);
  const std::vector<btScalar> right = heap.run(120);

  ASSERT_TRUE(heap.solver.restoreState(saved).ok());
  heap.cloths[1]->addVelocity({1, 2, 0});
  EXPECT_NE(heap.run(60), right);
  ASSERT_TRUE(heap.solver.restoreState(saved).ok());
  EXPECT_EQ(heap.run(120), right);

  Heap fresh;
  ASSERT_TRUE(fresh.solver.restoreState(saved).ok());
  EXPECT_EQ(fresh.run(120), right);
}

}  // namespace
}  // namespace oilskin::bullet
