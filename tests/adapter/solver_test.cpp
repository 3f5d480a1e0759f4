#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>
#include <gtest/gtest.h>

#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet {
namespace {

using namespace test;

TEST(FluidSoftBodySolver, couples_once_per_sub_step_and_momentum_is_the_cloths_and_the_fluids) {
  btFluidSoftBodySolver solver;
  SoftWorld bullet(btVector3(0, 0, 0), &solver);
  btSoftBody* cloth = bullet.patch(11, 0.4);  // free
  btFluid water(coarse_fluid(), small_world(), verified());
  ASSERT_TRUE(solver.addFluid(&water).ok());
  ASSERT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(
      water.addBox({bt(-0.08), bt(0.01), bt(-0.08)}, {bt(0.08), bt(0.09), bt(0.08)}, {0, -1, 0}).ok());
  EXPECT_EQ(bullet.world.stepSimulation(bt(0.0505), 100, bt(0.001)), 50);
  EXPECT_EQ(water.getWorld().step_count(), 50u);
  EXPECT_NEAR(water.getWorld().time(), 0.05, 1e-6);
  Vec3 fluid = Vec3::Zero();
  for (const Vec3& v : water.getWorld().velocities()) fluid += water.getWorld().particle_mass() * v;
  const Vec3 start = water.getNumParticles() * water.getWorld().particle_mass() * Vec3(0, -1, 0);
  EXPECT_LT(momentum(*cloth).y(), -0.02) << "the water pushes the cloth";
  EXPECT_LT((fluid + momentum(*cloth) - start).norm(), (is_double ? 1e-10 : 1e-4) * start.norm());
  EXPECT_EQ(solver.getReport().contact.crossings_found_by_verify, 0u);
}

TEST(FluidSoftBodySolver, coupling_interval_spans_sub_steps) {
  btFluidSoftBodySolver solver;
  SoftWorld bullet(btVector3(0, bt(-9.81), 0), &solver);
  btSoftBody* cloth = bullet.patch(7, 0.4, 0, 15);
  btFluid water(coarse_fluid(), small_world(), verified());
  ASSERT_TRUE(solver.addFluid(&water).ok());
  ASSERT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(water.addBox({bt(-0.08), bt(0.01), bt(-0.08)}, {bt(0.08), bt(0.05), bt(0.08)}).ok());
  solver.setCouplingInterval(4);
  for (int i = 0; i < 42; ++i) bullet.step(0.0005);
  EXPECT_EQ(water.getWorld().step_count(), 10u);
  EXPECT_NEAR(water.getWorld().time(), 0.02, 1e-6);
  EXPECT_NEAR(solver.getReport().dt, 0.002, 1e-8);
  EXPECT_EQ(solver.getReport().contact.crossings_found_by_verify, 0u);
  EXPECT_EQ(bullet.world.stepSimulation(bt(0.0001), 1, bt(0.001)), 0);
  EXPECT_EQ(water.getWorld().step_count(), 10u) << "no sub-step, no coupling";
}

TEST(FluidSoftBodySolver, without_a_fluid_it_is_bullets_default_solver) {
  btFluidSoftBodySolver ours;
  SoftWorld with(btVector3(0, bt(-9.81), 0), &ours), without(btVector3(0, bt(-9.81), 0));
  btSoftBody* a = with.patch(7, 0.4, 0, 15);
  btSoftBody* b = without.patch(7, 0.4, 0, 15);
  for (int i = 0; i < 20; ++i) {
    with.step(0.001);
    without.step(0.001);
  }
  // CreatePatch shuffles links with a seed of the process, so the two differ by the solver's order only.
  for (int i = 0; i < a->m_nodes.size(); ++i)
    EXPECT_LT((to_vec3(a->m_nodes[i].m_x) - to_vec3(b->m_nodes[i].m_x)).norm(), 1e-3);
  EXPECT_GT(a->m_nodes[24].m_n.length(), bt(0.9)) << "normals are renewed";
}

TEST(FluidSoftBodySolver, normals_are_those_of_the_corrected_positions) {
  btFluidSoftBodySolver solver;
  SoftWorld bullet(btVector3(0, bt(-9.81), 0), &solver);
  btSoftBody* cloth = bullet.patch(7, 0.4, 0, 15);
  btFluid water(coarse_fluid(), small_world(), verified());
  ASSERT_TRUE(solver.addFluid(&water).ok());
  ASSERT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(
      water.addBox({bt(-0.08), bt(0.01), bt(-0.08)}, {bt(0.08), bt(0.09), bt(0.08)}, {0, -2, 0}).ok());
  for (int i = 0; i < 50; ++i) bullet.step(0.001);
  std::vector<btVector3> normals;
  for (int i = 0; i < cloth->m_nodes.size(); ++i) normals.push_back(cloth->m_nodes[i].m_n);
  cloth->updateNormals();
  for (int i = 0; i < cloth->m_nodes.size(); ++i) EXPECT_EQ(normals[std::size_t(i)], cloth->m_nodes[i].m_n);
}

/// A sheet of cloth under a box of water.
struct WetSheet {
  btFluidSoftBodySolver solver;
  SoftWorld bullet{btVector3(0, bt(-9.81), 0), &solver};
  btFluid water{coarse_fluid(), small_world(), verified()};
  btSoftBody* cloth = nullptr;

  WetSheet() {
    cloth = bullet.patch(7, 0.4, 0, 15);
    EXPECT_TRUE(solver.addFluid(&water).ok());
    EXPECT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
    EXPECT_TRUE(
        water.addBox({bt(-0.08), bt(0.01), bt(-0.08)}, {bt(0.08), bt(0.09), bt(0.08)}, {0, -2, 0}).ok());
  }
  std::vector<btVector3> normals() const {
    std::vector<btVector3> n;
    for (int i = 0; i < cloth->m_nodes.size(); ++i) n.push_back(cloth->m_nodes[i].m_n);
    return n;
  }
};

TEST(FluidSoftBodySolver, sub_steps_without_normals_move_everything_alike) {
  WetSheet with, without;
  EXPECT_TRUE(without.solver.getUpdatesNormals());
  without.solver.setUpdatesNormals(false);
  const std::vector<btVector3> at_start = without.normals();
  for (int i = 0; i < 50; ++i) {
    with.bullet.step(0.001);
    without.bullet.step(0.001);
  }
  EXPECT_EQ(with.water.getWorld().state_hash(), without.water.getWorld().state_hash());
  for (int i = 0; i < with.cloth->m_nodes.size(); ++i)
    ASSERT_EQ(with.cloth->m_nodes[i].m_x, without.cloth->m_nodes[i].m_x);
  EXPECT_EQ(without.normals(), at_start);
  EXPECT_NE(with.normals(), at_start);
  without.solver.setUpdatesNormals(true);
  with.bullet.step(0.001);
  without.bullet.step(0.001);
  EXPECT_EQ(with.normals(), without.normals());
}

TEST(FluidSoftBodySolver, bodies_with_pressure_or_drag_always_get_their_normals) {
  for (btScalar btSoftBody::Config::*const factor : {&btSoftBody::Config::kDP, &btSoftBody::Config::kLF,
                                                     &btSoftBody::Config::kPR, &btSoftBody::Config::kVC}) {
    WetSheet sheet;
    sheet.solver.setUpdatesNormals(false);
    const std::vector<btVector3> at_start = sheet.normals();
    sheet.cloth->m_cfg.*factor = bt(1e-3);
    for (int i = 0; i < 50; ++i) sheet.bullet.step(0.001);
    EXPECT_NE(sheet.normals(), at_start);
  }
}

TEST(FluidSoftBodySolver, dragged_pins_sweep_the_water_along) {
  btFluidSoftBodySolver solver;
  SoftWorld bullet(btVector3(0, 0, 0), &solver);
  btSoftBody* cloth = bullet.patch(7, 0.4);
  for (int i = 0; i < cloth->m_nodes.size(); ++i) cloth->m_nodes[i].m_im = 0;  // all moved by hand
  btFluid water(coarse_fluid(), small_world(), verified());
  ASSERT_TRUE(solver.addFluid(&water).ok());
  ASSERT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(water.addBox({bt(-0.05), bt(0.02), bt(-0.05)}, {bt(0.05), bt(0.06), bt(0.05)}).ok());
  for (int step = 1; step <= 60; ++step) {
    for (int i = 0; i < cloth->m_nodes.size(); ++i) cloth->m_nodes[i].m_x += btVector3(0, bt(0.002), 0);
    bullet.step(0.001);
    ASSERT_EQ(solver.getReport().contact.crossings_found_by_verify, 0u);
  }
  ASSERT_GT(water.getNumParticles(), 20);
  for (int i = 0; i < water.getNumParticles(); ++i) EXPECT_GT(water.getPosition(i).y(), bt(0.12));
}

TEST(FluidSoftBodySolver, works_as_the_fifth_argument_of_the_multi_body_world) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver constraints;
  btFluidSoftBodySolver solver;
  btSoftMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world.getWorldInfo().m_gravity = btVector3(0, bt(-9.81), 0);
  btSoftBody* cloth =
      btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {bt(-0.2), 0, bt(-0.2)}, {bt(0.2), 0, bt(-0.2)},
                                     {bt(-0.2), 0, bt(0.2)}, {bt(0.2), 0, bt(0.2)}, 7, 7, 15, true);
  cloth->setTotalMass(bt(0.05));
  world.addSoftBody(cloth);
  btFluid water(coarse_fluid(), small_world(), verified());
  ASSERT_TRUE(solver.addFluid(&water).ok());
  ASSERT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(water.addBox({bt(-0.05), bt(0.01), bt(-0.05)}, {bt(0.05), bt(0.05), bt(0.05)}).ok());
  for (int i = 0; i < 30; ++i) world.stepSimulation(bt(0.001), 0);
  EXPECT_EQ(water.getWorld().step_count(), 30u);
  EXPECT_EQ(solver.getReport().contact.crossings_found_by_verify, 0u);
  solver.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
}

}  // namespace
}  // namespace oilskin::bullet
