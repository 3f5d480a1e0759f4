#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>
#include <gtest/gtest.h>

#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet {
namespace {

using namespace test;

const btVector3 down(0, bt(-9.81), 0);

struct SmallFluid : btFluid {
  SmallFluid() : btFluid(coarse_fluid(), small_world(), verified()) {}
};

void expect_sound(const StepReport& report) {
  ASSERT_TRUE(report.status.ok()) << report.status.message;
  EXPECT_EQ(report.contact.crossings_found_by_verify, 0u);
  EXPECT_EQ(report.flags & (flag_leaked | flag_scatter_mismatch | flag_no_promise | flag_surface_refused), 0u)
      << (report.messages.empty() ? "" : report.messages[0]);
}

TEST(FluidCoupling, explicit_step_with_bullets_own_solver) {
  SoftWorld bullet(down);
  btSoftBody* cloth = bullet.patch(11, 0.4, 0, 15);
  SmallFluid water;
  ASSERT_TRUE(water.addBox({bt(-0.08), bt(0.03), bt(-0.08)}, {bt(0.08), bt(0.11), bt(0.08)}).ok());
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  EXPECT_EQ(water.getNumParticles(), 0);
  Vec3 hit = Vec3::Zero();
  for (int i = 0; i < 200; ++i) {
    bullet.step(0.001);
    expect_sound(coupling.step(bt(0.001)));
    for (const Vec3& j : *coupling.getNodeImpulses(cloth)) hit += j;
  }
  EXPECT_GT(water.getNumParticles(), 100);
  EXPECT_LT(hit.y(), -0.01) << "the water pushes the cloth down";
  ASSERT_NE(coupling.getSurface(cloth), nullptr);
  EXPECT_EQ(coupling.getSurface(cloth)->x_t1[7], to_vec3(cloth->m_nodes[7].m_x));
  coupling.removeCloth(cloth);
  EXPECT_EQ(coupling.getSurface(cloth), nullptr);
  EXPECT_EQ(coupling.getNodeImpulses(cloth), nullptr);
}

/// Bullet's world with contact of its own between soft bodies. Its solver cannot be replaced by ours.
struct DeformableWorld {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDeformableBodySolver deformable;
  btDeformableMultiBodyConstraintSolver constraints;
  btDeformableMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &constraints, &configuration,
                                           &deformable};
  btDeformableMassSpringForce springs{bt(50), bt(0.5), true, bt(0.01)};
  btDeformableGravityForce weight{down};
  std::unique_ptr<btSoftBody> cloth;

  DeformableWorld() {
    constraints.setDeformableSolver(&deformable);
    world.setGravity(down);
    world.getWorldInfo().m_gravity = down;
    const btScalar r = bt(0.2);
    cloth.reset(btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r}, {-r, 0, r},
                                               {r, 0, r}, 11, 11, 15, true));
    cloth->setTotalMass(bt(0.1));
    cloth->setDampingCoefficient(bt(0.01));
    world.addSoftBody(cloth.get());
    world.addForce(cloth.get(), &springs);
    world.addForce(cloth.get(), &weight);
  }
  ~DeformableWorld() {
    world.removeSoftBodyForce(cloth.get());
    world.removeSoftBody(cloth.get());
  }
};

TEST(FluidCoupling, explicit_step_in_bullets_deformable_world) {
  DeformableWorld bullet;
  SmallFluid water;
  ASSERT_TRUE(water.addBox({bt(-0.08), bt(0.03), bt(-0.08)}, {bt(0.08), bt(0.11), bt(0.08)}).ok());
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCloth(bullet.cloth.get(), bt(0.002)).ok());
  Vec3 hit = Vec3::Zero();
  for (int i = 0; i < 200; ++i) {
    bullet.world.stepSimulation(bt(0.001), 0);
    expect_sound(coupling.step(bt(0.001)));
    for (const Vec3& j : *coupling.getNodeImpulses(bullet.cloth.get())) hit += j;
  }
  EXPECT_GT(water.getNumParticles(), 100);
  EXPECT_LT(hit.y(), -0.01) << "the water pushes the cloth down";
  for (int i = 0; i < bullet.cloth->m_nodes.size(); ++i)
    EXPECT_TRUE(to_vec3(bullet.cloth->m_nodes[i].m_x).allFinite());
}

TEST(FluidCoupling, zero_sub_steps_couple_nothing_and_the_motion_accumulates) {
  SoftWorld bullet(down);
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 15);
  SmallFluid water;
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  bullet.step(0.001);
  coupling.step(bt(0.001));
  const Vec3 start = to_vec3(cloth->m_nodes[12].m_x);
  EXPECT_EQ(coupling.step(0).step, coupling.getReport().step);
  EXPECT_EQ(water.getWorld().step_count(), 1u);
  for (int i = 0; i < 3; ++i) bullet.step(0.001);
  ASSERT_TRUE(coupling.step(bt(0.003)).status.ok());
  EXPECT_EQ(coupling.getSurface(cloth)->x_t0[12], start);
  EXPECT_FALSE(coupling.step(bt(-1)).status.ok());
}

TEST(FluidCoupling, gravity_is_the_cloths_unless_told_otherwise) {
  SoftWorld bullet(btVector3(0, 0, bt(-1.5)));
  btSoftBody* cloth = bullet.patch(5, 0.4);
  SmallFluid water;
  btFluidCoupling coupling(&water);
  coupling.step(bt(0.001));
  EXPECT_EQ(water.getWorld().settings().gravity, Vec3(0, -9.81, 0)) << "no cloth";
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  coupling.step(bt(0.001));
  EXPECT_EQ(water.getWorld().settings().gravity, Vec3(0, 0, -1.5));
  coupling.setUseClothGravity(false);
  ASSERT_TRUE(water.getWorld().set_gravity(Vec3(1, 0, 0)).ok());
  coupling.step(bt(0.001));
  EXPECT_EQ(water.getWorld().settings().gravity, Vec3(1, 0, 0));
}

TEST(FluidCoupling, refusals_say_why_and_attach_nothing) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  btSoftBody* rope = bullet.own(btSoftBodyHelpers::CreateRope(bullet.world.getWorldInfo(), btVector3(0, 0, 0),
                                                              btVector3(1, 0, 0), 8, 0));
  btBoxShape box(btVector3(1, 1, 1));
  btRigidBody dynamic(1, nullptr, &box, btVector3(1, 1, 1));
  SmallFluid water;
  btFluidCoupling coupling(&water);
  auto why = [](const Status& status) { return status.message; };
  EXPECT_NE(why(coupling.addCloth(rope, bt(0.002))).find("no faces"), std::string::npos);
  EXPECT_NE(why(coupling.addCloth(nullptr, bt(0.002))).find("null"), std::string::npos);
  EXPECT_NE(why(coupling.addCloth(cloth, bt(-1))).find("thickness"), std::string::npos);
  EXPECT_FALSE(coupling.addCloth(cloth, bt(1e-14)).ok()) << "below 4 δ";
  EXPECT_NE(why(coupling.addCollisionObject(cloth, bt(0.002))).find("addCloth"), std::string::npos);
  EXPECT_NE(why(coupling.addCollisionObject(&dynamic, bt(0.002))).find("CF_KINEMATIC_OBJECT"),
            std::string::npos);
  EXPECT_EQ(water.getWorld().surface_count(), 0u);
  EXPECT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  EXPECT_NE(why(coupling.addCloth(cloth, bt(0.002))).find("already"), std::string::npos);
  EXPECT_EQ(water.getWorld().surface_count(), 1u);
  btFluid bad(bt(-1));
  btFluidCoupling other;
  EXPECT_NE(why(other.addFluid(&bad)).find("spacing"), std::string::npos);
  EXPECT_FALSE(btFluidCoupling(&bad).step(bt(0.001)).status.ok());
  EXPECT_FALSE(other.addFluid(&water).ok()) << "it is in another coupling";
  EXPECT_FALSE(coupling.addFluid(&water).ok());
  EXPECT_FALSE(other.step(bt(0.001)).status.ok()) << "no fluid";
}

TEST(FluidCoupling, attach_and_detach_in_any_order) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  btBoxShape shape(btVector3(1, bt(0.1), 1));
  btCollisionObject floor;
  floor.setCollisionShape(&shape);
  auto coupling = std::make_unique<btFluidCoupling>();
  ASSERT_TRUE(coupling->addCloth(cloth, bt(0.002)).ok()) << "before the fluid";
  ASSERT_TRUE(coupling->addCollisionObject(&floor, bt(0.002)).ok());
  EXPECT_EQ(coupling->getSurface(cloth), nullptr);
  auto water = std::make_unique<SmallFluid>();
  ASSERT_TRUE(coupling->addFluid(water.get()).ok());
  EXPECT_EQ(water->getWorld().surface_count(), 2u);
  ASSERT_NE(coupling->getSurface(&floor), nullptr);
  ASSERT_TRUE(coupling->step(bt(0.001)).status.ok());
  coupling->removeCollisionObject(&floor);
  coupling->removeCollisionObject(&floor);
  EXPECT_EQ(water->getWorld().surface_count(), 1u);
  water.reset();  // the fluid goes first
  EXPECT_EQ(coupling->getFluid(), nullptr);
  EXPECT_FALSE(coupling->step(bt(0.001)).status.ok());
  SmallFluid other;
  ASSERT_TRUE(coupling->addFluid(&other).ok());
  EXPECT_EQ(other.getWorld().surface_count(), 1u);
  coupling.reset();  // the coupling goes first
  EXPECT_EQ(other.getWorld().surface_count(), 0u);
  EXPECT_TRUE(other.getWorld().step(0.001).status.ok());
}

TEST(FluidCoupling, surfaces_that_the_fluids_precision_cannot_serve_refuse_the_fluid) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  btFluidCoupling coupling;
  ASSERT_TRUE(coupling.addCloth(cloth, bt(1e-14)).ok());
  SmallFluid water;
  EXPECT_FALSE(coupling.addFluid(&water).ok());
  EXPECT_EQ(coupling.getFluid(), nullptr);
  EXPECT_EQ(water.getWorld().surface_count(), 0u);
}

TEST(FluidCoupling, cloth_that_changes_while_attached_goes_on) {
  SoftWorld bullet(down);
  btSoftBody* cloth = bullet.patch(7, 0.4, 0, 15);
  SmallFluid water;
  ASSERT_TRUE(water.addBox({bt(-0.06), bt(0.03), bt(-0.06)}, {bt(0.06), bt(0.09), bt(0.06)}).ok());
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  for (int i = 0; i < 60; ++i) {
    if (i == 30) {
      cloth->appendNode(btVector3(0, bt(-0.5), 0), bt(0.01));
      cloth->appendFace(0, 1, cloth->m_nodes.size() - 1);
      cloth->m_nodes[cloth->m_nodes.size() - 1].m_im = 0;
    }
    if (i == 45) cloth->m_faces.pop_back();
    bullet.step(0.001);
    expect_sound(coupling.step(bt(0.001)));
    ASSERT_EQ(coupling.getNodeImpulses(cloth)->size(), static_cast<std::size_t>(cloth->m_nodes.size()));
  }
}

TEST(FluidCoupling, reset_motion_is_a_teleport) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 15);
  SmallFluid water;
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCloth(cloth, bt(0.002)).ok());
  bullet.step(0.001);
  coupling.step(bt(0.001));
  for (int i = 0; i < cloth->m_nodes.size(); ++i) cloth->m_nodes[i].m_x += btVector3(0, bt(0.5), 0);
  coupling.resetMotion(cloth);
  expect_sound(coupling.step(bt(0.001)));
  const SurfaceMotion& motion = *coupling.getSurface(cloth);
  for (std::size_t i = 0; i < motion.x_t1.size(); ++i) {
    EXPECT_EQ(motion.x_t0[i], motion.x_t1[i]);
    EXPECT_LT(motion.velocity[i].norm(), 0.1);
  }
}

TEST(FluidCoupling, water_rests_in_a_box_of_collision_objects) {
  btStaticPlaneShape floor_shape(btVector3(0, 1, 0), 0);
  btBoxShape wall_shape(btVector3(bt(0.02), bt(0.2), bt(0.2)));
  btCollisionObject floor, walls[4];
  floor.setCollisionShape(&floor_shape);
  SmallFluid water;
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCollisionObject(&floor, bt(0.002)).ok());
  for (int i = 0; i < 4; ++i) {
    const btQuaternion turn(btVector3(0, 1, 0), bt(i * 1.5707963267948966));
    walls[i].setCollisionShape(&wall_shape);
    walls[i].setWorldTransform(btTransform(turn, quatRotate(turn, btVector3(bt(0.12), bt(0.1), 0))));
    ASSERT_TRUE(coupling.addCollisionObject(&walls[i], bt(0.002)).ok());
  }
  ASSERT_TRUE(water.addBox({bt(-0.09), bt(0.01), bt(-0.09)}, {bt(0.09), bt(0.07), bt(0.09)}).ok());
  Vec3 weight = Vec3::Zero();
  for (int i = 0; i < 600; ++i) {
    expect_sound(coupling.step(bt(0.001)));
    if (i >= 300)
      for (const Vec3& j : coupling.getSurface(&floor)->impulse) weight += j / 0.3;
  }
  const int n = water.getNumParticles();
  ASSERT_GT(n, 150);
  for (int i = 0; i < n; ++i) {
    const btVector3 x = water.getPosition(i);
    EXPECT_GT(x.y(), 0);
    EXPECT_LT(std::max(std::abs(x.x()), std::abs(x.z())), bt(0.1));
  }
  const double carried = n * water.getWorld().particle_mass() * 9.81;
  EXPECT_NEAR(-weight.y(), carried, 0.05 * carried) << "the floor carries the water";
}

TEST(FluidCoupling, kinematic_box_pushes_water) {
  btBoxShape shape(btVector3(bt(0.2), bt(0.02), bt(0.2)));
  btCollisionObject plate;
  plate.setCollisionShape(&shape);
  SmallFluid water;
  ASSERT_TRUE(water.getWorld().set_gravity(Vec3::Zero()).ok());
  ASSERT_TRUE(water.addBox({bt(-0.05), bt(0.03), bt(-0.05)}, {bt(0.05), bt(0.07), bt(0.05)}).ok());
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCollisionObject(&plate, bt(0.002)).ok());
  for (int i = 0; i < 100; ++i) {
    plate.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, bt(0.001 * i), 0)));
    expect_sound(coupling.step(bt(0.001)));
  }
  for (int i = 0; i < water.getNumParticles(); ++i) EXPECT_GT(water.getPosition(i).y(), bt(0.119));
}

TEST(Fluid, reads_out_in_bullets_numbers_and_in_strides) {
  SmallFluid water;
  ASSERT_TRUE(water.addBox({0, 0, 0}, {bt(0.1), bt(0.1), bt(0.1)}, {1, 0, 0}).ok());
  ASSERT_TRUE(water.getWorld().step(0.001).status.ok());
  const auto n = static_cast<std::size_t>(water.getNumParticles());
  ASSERT_GT(n, 50u);
  std::vector<float> x(4 * n, -7.f), v(3 * n);
  water.copyPositions(x.data(), 16);
  water.copyVelocities(v.data());
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(x[4 * i + 1], static_cast<float>(water.getWorld().positions()[i].y()));
    EXPECT_EQ(x[4 * i + 3], -7.f);
    EXPECT_EQ(v[3 * i], static_cast<float>(water.getWorld().velocities()[i].x()));
    EXPECT_EQ(to_vec3(water.getPosition(static_cast<int>(i))).x(),
              static_cast<double>(static_cast<btScalar>(water.getWorld().positions()[i].x())));
  }
}

TEST(Fluid, a_step_may_have_a_time_limit) {
  btFluid water(coarse_fluid(), small_world(), ContactSettings());
  EXPECT_EQ(water.getStepBudget(), 0);
  EXPECT_TRUE(water.setStepBudget(bt(0.25)).ok());
  EXPECT_EQ(water.getStepBudget(), bt(0.25));
  EXPECT_FALSE(water.setStepBudget(-1).ok());
  EXPECT_EQ(water.getStepBudget(), bt(0.25));
}

TEST(Fluid, jets_start_at_the_present_time) {
  SmallFluid water;
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(water.getWorld().step(0.001).status.ok());
  ASSERT_TRUE(water.addJet({0, 0, 0}, {0, -2, 0}, bt(1), bt(0.05)).ok());
  const StepReport& report = water.getWorld().step(0.001);
  EXPECT_LT(report.emitted, 100u) << "not those of the time before";
  EXPECT_FALSE(water.addJet({0, 0, 0}, {0, 0, 0}, 1, 1).ok());
}

/// Counts what it is asked to draw.
class CountingDrawer : public btIDebugDraw {
 public:
  int lines = 0, contacts = 0, mode = 0;
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override { ++lines; }
  void drawContactPoint(const btVector3&, const btVector3& n, btScalar, int, const btVector3&) override {
    EXPECT_NEAR(n.length(), 1, 1e-5);
    ++contacts;
  }
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int m) override { mode = m; }
  int getDebugMode() const override { return mode; }
};

TEST(FluidCoupling, debug_draw_through_bullets_world) {
  SoftWorld bullet(down);
  btStaticPlaneShape floor_shape(btVector3(0, 1, 0), 0);
  btCollisionObject floor;
  floor.setCollisionShape(&floor_shape);
  SmallFluid water;
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCollisionObject(&floor, bt(0.002)).ok());
  ASSERT_TRUE(water.addBox({0, bt(0.005), 0}, {bt(0.1), bt(0.1), bt(0.1)}).ok());
  bullet.world.addAction(&coupling);
  for (int i = 0; i < 80; ++i) coupling.step(bt(0.001));
  const auto steps = water.getWorld().step_count();
  bullet.step(0.001);
  EXPECT_EQ(water.getWorld().step_count(), steps) << "an action couples nothing";
  CountingDrawer drawer;
  bullet.world.setDebugDrawer(&drawer);
  drawer.setDebugMode(btIDebugDraw::DBG_DrawWireframe | btIDebugDraw::DBG_DrawContactPoints);
  bullet.world.debugDrawWorld();
  EXPECT_EQ(drawer.lines, water.getNumParticles());
  EXPECT_GT(drawer.contacts, 0);
  bullet.world.removeAction(&coupling);
}

}  // namespace
}  // namespace oilskin::bullet
