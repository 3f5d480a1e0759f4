// The ways in which Bullet's users drive their worlds, each with water on the cloth: nothing crosses, as the
// exact auditor finds on the stored paths, the momentum ledger is closed, and the water is where it should
// be.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>

#include <set>

#include "audited_water.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr int nodes_across = 13;
constexpr double bowl_depth = 0.06;
constexpr btScalar h = btScalar(sheet_thickness);

/// 0.4 m across, its border pinned, sunk in the middle by `depth` in its rest shape.
template <class Bullet>
btSoftBody* framed(Bullet& bullet, double y, double depth) {
  btSoftBody* cloth = bullet.patch(nodes_across, 0.4, y, 0, 0.2);
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    btVector3& x = cloth->m_nodes[i].m_x;
    const btScalar a = x.x() / bt(0.2), b = x.z() / bt(0.2);
    x.setY(x.y() - bt(depth) * (1 - a * a) * (1 - b * b));
  }
  pin_border(cloth, nodes_across);  // setMass() makes the present shape the rest shape
  cloth->m_cfg.piterations = 10;
  return cloth;
}

/// A world with the injected solver and its water; pour() drops 128 particles.
template <class Bullet>
struct Hosted {
  explicit Hosted(const btVector3& gravity = down, double kill_box = 2)
      : bullet(gravity, &solver), water(kill_box) {
    EXPECT_TRUE(solver.addFluid(&water).ok());
  }

  btSoftBody* cloth(double y = 0) { return attached(framed(bullet, y, 0)); }
  btSoftBody* bowl(double y = 0) { return attached(framed(bullet, y, bowl_depth)); }
  btSoftBody* attached(btSoftBody* body) {
    EXPECT_TRUE(solver.addCloth(body, h).ok());
    return body;
  }

  void pour(double y, double half = 0.08) {
    ASSERT_TRUE(water.addBox({bt(-half), bt(y), bt(-half)}, {bt(half), bt(y + 0.04), bt(half)}).ok());
  }

  void step(double dt = 0.001) {
    bullet.step(dt);
    water.expect_sound(solver.getReport());
  }

  LedgerSolver solver;
  Bullet bullet;
  AuditedWater water;
};

using Soft = Hosted<SoftWorld>;
using MultiBody = Hosted<BasicSoftWorld<btSoftMultiBodyDynamicsWorld, btMultiBodyConstraintSolver>>;

/// The height of the node in the middle.
double middle(const btSoftBody& cloth) {
  return static_cast<double>(cloth.m_nodes[cloth.m_nodes.size() / 2].m_x.y());
}

#define RUN(call) ASSERT_NO_FATAL_FAILURE(call)

TEST(Drivers, explicit_step_after_bullets_sub_steps) {
  SoftWorld bullet(down);
  btSoftBody* cloth = framed(bullet, 0, bowl_depth);
  AuditedWater water;
  btFluidCoupling coupling(&water);
  ASSERT_TRUE(coupling.addCloth(cloth, h).ok());
  ASSERT_TRUE(water.addBox({bt(-0.08), 0, bt(-0.08)}, {bt(0.08), bt(0.04), bt(0.08)}).ok());
  const double fixed = 1.0 / 960;
  int sub_steps = 0;
  for (int frame = 0; frame < 100; ++frame) {
    // Frames of 1/240 s and, now and then, shorter than a sub-step.
    const int n = bullet.world.stepSimulation(bt(frame % 7 == 3 ? 1.0 / 2000 : 1.0 / 240), 8, bt(fixed));
    sub_steps += n;
    expect_nodes_get_what_is_booked(bullet.world.getSoftBodyArray(), water.getWorld(),
                                    [&] { coupling.step(bt(n * fixed)); });
    RUN(water.expect_sound(coupling.getReport()));
  }
  EXPECT_NEAR(water.getWorld().time(), sub_steps * fixed, 1e-6);
  EXPECT_GT(water.contacts, 1000u);
  EXPECT_LT(middle(*cloth), -bowl_depth) << "the water weighs on the cloth";
  EXPECT_EQ(water.carried_by(*cloth), 128);
}

TEST(Drivers, multi_body_whose_link_strikes_the_cloth_from_below) {
  MultiBody host;
  // A lever on a fixed base; its link, a ball at the end of an arm, comes up under the water.
  btSphereShape ball(bt(0.05));
  btVector3 inertia;
  ball.calculateLocalInertia(1, inertia);
  btMultiBody lever(1, 0, btVector3(0, 0, 0), true, false);
  lever.setBasePos(btVector3(bt(-0.3), bt(-0.25), 0));
  lever.setupRevolute(0, 1, inertia, -1, btQuaternion::getIdentity(), btVector3(0, 0, 1), btVector3(0, 0, 0),
                      btVector3(bt(0.3), 0, 0), true);
  lever.finalizeMultiDof();
  lever.setJointVel(0, bt(7));
  btMultiBodyLinkCollider link(&lever, 0);
  link.setCollisionShape(&ball);
  link.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, bt(-0.25), 0)));
  lever.getLink(0).m_collider = &link;
  host.bullet.world.addMultiBody(&lever);
  host.bullet.world.addCollisionObject(&link);

  btSoftBody* cloth = host.bowl();
  host.pour(0);
  double highest = -1, lowest = 1;
  for (int i = 0; i < 400; ++i) {
    RUN(host.step());
    highest = std::max(highest, middle(*cloth));
    lowest = std::min(lowest, middle(*cloth));
  }
  EXPECT_GT(highest, -bowl_depth + 0.01) << "the ball lifts the cloth";
  EXPECT_GT(host.water.contacts, 1000u);
  EXPECT_EQ(host.water.carried_by(*cloth), 128);
  host.bullet.world.removeCollisionObject(&link);
  host.bullet.world.removeMultiBody(&lever);
}

TEST(Drivers, cloth_anchored_to_a_body_that_swings) {
  Soft host;
  // A frame hangs from a point above it and carries the cloth at its border.
  btBoxShape shape(btVector3(bt(0.2), bt(0.01), bt(0.2)));
  btVector3 inertia;
  shape.calculateLocalInertia(4, inertia);
  btRigidBody frame(btRigidBody::btRigidBodyConstructionInfo(4, nullptr, &shape, inertia));
  frame.setActivationState(DISABLE_DEACTIVATION);
  host.bullet.world.addRigidBody(&frame);
  btPoint2PointConstraint hook(frame, btVector3(0, bt(0.6), 0));
  host.bullet.world.addConstraint(&hook, true);
  btSoftBody* cloth = framed(host.bullet, 0, bowl_depth);
  const double node_mass = 0.2 / (nodes_across * nodes_across);
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    if (cloth->m_nodes[i].m_im > 0) continue;
    cloth->setMass(i, bt(node_mass));
    cloth->appendAnchor(i, &frame, /*disableCollisionBetweenLinkedBodies=*/true);
  }
  host.attached(cloth);
  host.pour(0);
  double right = 0, left = 0, parted = 0;
  for (int i = 0; i < 1200; ++i) {
    if (i == 200) {
      frame.setLinearVelocity(btVector3(bt(0.6), 0, 0));
      frame.setAngularVelocity(btVector3(0, 0, 1));
    }
    RUN(host.step());
    const double x = static_cast<double>(frame.getWorldTransform().getOrigin().x());
    right = std::max(right, x), left = std::min(left, x);
    for (int k = 0; k < cloth->m_anchors.size(); ++k) {
      const btSoftBody::Anchor& a = cloth->m_anchors[k];
      const btVector3 hand = frame.getWorldTransform() * a.m_local;
      parted = std::max(parted, static_cast<double>((hand - a.m_node->m_x).length()));
    }
  }
  EXPECT_GT(right, 0.05) << "the frame swings";
  EXPECT_LT(left, -0.02) << "and back";
  EXPECT_LT(parted, 0.01) << "and holds the cloth";
  EXPECT_GT(host.water.contacts, 1000u);
  EXPECT_EQ(host.water.carried_by(*cloth), 128);
  host.bullet.world.removeConstraint(&hook);
  cloth->m_anchors.clear();
  host.bullet.world.removeRigidBody(&frame);
}

TEST(Drivers, box_that_falls_into_a_cloth_with_water_on_it) {
  Soft host;
  btSoftBody* cloth = host.bowl();
  host.pour(0);
  btBoxShape shape(btVector3(bt(0.05), bt(0.05), bt(0.05)));
  btVector3 inertia;
  shape.calculateLocalInertia(bt(0.3), inertia);
  btRigidBody box(btRigidBody::btRigidBodyConstructionInfo(bt(0.3), nullptr, &shape, inertia));
  box.setWorldTransform(btTransform(btQuaternion(bt(0.3), bt(0.2), bt(0.5)), btVector3(0, bt(0.2), 0)));
  host.bullet.world.addRigidBody(&box);
  for (int i = 0; i < 200; ++i) RUN(host.step());
  const double before = middle(*cloth);
  double lowest = before;
  for (int i = 0; i < 500; ++i) {
    RUN(host.step());
    lowest = std::min(lowest, middle(*cloth));
  }
  EXPECT_LT(lowest, before - 0.01) << "the box dents the cloth";
  EXPECT_GT(box.getWorldTransform().getOrigin().y(), bt(-0.2)) << "and is caught";
  EXPECT_GT(host.water.contacts, 1000u);
  EXPECT_EQ(host.water.carried_by(*cloth), host.water.getNumParticles());
  host.bullet.world.removeRigidBody(&box);
}

TEST(Drivers, several_cloths_with_water_on_each_and_between) {
  Soft host;
  btSoftBody* low = host.bowl(-0.2);
  btSoftBody* high = host.bowl(0);
  btSoftBody* loose = host.bullet.patch(9, 0.2, 0.02, 0, 0.01);
  SlipSettings sticky;
  sticky.model = SlipModel::coulomb;
  ASSERT_TRUE(host.solver.addCloth(loose, h, sticky).ok());
  host.pour(-0.03, 0.06);
  host.pour(-0.23, 0.06);
  std::set<std::uint64_t> spilled;  // over the border of the upper one, where the loose one splashes
  for (int i = 0; i < 500; ++i) {
    RUN(host.step());
    const World& w = host.water.getWorld();
    for (std::size_t p = 0; p < w.particle_count(); ++p) {
      const Vec3& x = w.positions()[p];
      if (x.y() > -0.05 && std::max(std::abs(x.x()), std::abs(x.z())) > 0.2) spilled.insert(w.ids()[p]);
    }
  }
  EXPECT_EQ(host.water.getWorld().surface_count(), 3u);
  EXPECT_LT(middle(*loose), 0) << "it came down on the water";
  EXPECT_GT(host.water.contacts, 2000u);
  EXPECT_EQ(host.water.getNumParticles(), 144);
  EXPECT_LT(spilled.size(), 24u) << "a splash over the border, not the pool";
  EXPECT_GE(host.water.carried_by(*high) + static_cast<int>(spilled.size()), 72);
  EXPECT_GE(host.water.carried_by(*low) + static_cast<int>(spilled.size()), 144);
}

TEST(Drivers, cloths_that_come_and_go_while_it_runs) {
  Soft host;
  btSoftBody* floor = host.bowl(-0.1);
  host.pour(-0.13);
  for (int i = 0; i < 200; ++i) RUN(host.step());
  std::uint64_t relocated = 0;
  for (int round = 0; round < 8; ++round) {
    // A new sheet lies exactly at a particle's place.
    int lowest = 0;
    for (int i = 0; i < host.water.getNumParticles(); ++i)
      if (host.water.getPosition(i).y() < host.water.getPosition(lowest).y()) lowest = i;
    btSoftBody* sheet = host.cloth(static_cast<double>(host.water.getPosition(lowest).y()));
    ASSERT_EQ(host.water.getWorld().surface_count(), 2u);
    for (int i = 0; i < 15; ++i) {
      RUN(host.step());
      relocated += host.solver.getReport().contact.relocated;
    }
    host.solver.removeCloth(sheet);  // it stays in Bullet's world, and comes back as it then is
    ASSERT_EQ(host.water.getWorld().surface_count(), 1u);
    for (int i = 0; i < 10; ++i) RUN(host.step());
    host.attached(sheet);
    for (int i = 0; i < 15; ++i) RUN(host.step());
    host.solver.removeCloth(sheet);
    host.bullet.destroy(sheet);
    for (int i = 0; i < 10; ++i) RUN(host.step());
  }
  EXPECT_GT(host.water.contacts, 2000u);
  EXPECT_GE(relocated, 8u) << "a particle where the sheet appears gets another place, or is removed";
  EXPECT_GE(host.water.getNumParticles(), 128 - static_cast<int>(relocated));
  EXPECT_EQ(host.water.carried_by(*floor), host.water.getNumParticles());
}

/// A sheet of mass-0 nodes: where it goes is the user's.
struct Dragged : Soft {
  explicit Dragged(double kill_box) : Soft(btVector3(0, 0, 0), kill_box) {
    sheet = cloth();
    for (int i = 0; i < sheet->m_nodes.size(); ++i) sheet->setMass(i, 0);
    pour(0.01);
  }
  void move(const btVector3& by) {
    for (int i = 0; i < sheet->m_nodes.size(); ++i) sheet->m_nodes[i].m_x += by;
  }
  btSoftBody* sheet;
};

TEST(Drivers, pins_dragged_ten_metres_in_a_step) {
  Dragged host(12);
  RUN(host.step());
  ASSERT_EQ(host.water.getNumParticles(), 128);
  host.move(btVector3(10, 0, 0));  // along itself: the water stays
  RUN(host.step());
  EXPECT_EQ(host.water.carried_by(*host.sheet), 0);
  EXPECT_EQ(host.water.getNumParticles(), 128);
  host.move(btVector3(-10, 0, 0));
  RUN(host.step());
  EXPECT_EQ(host.water.carried_by(*host.sheet), 128);
  host.move(btVector3(0, 10, 0));  // through it: the water goes along
  RUN(host.step());
  EXPECT_GT(host.water.contacts, 64u);
  EXPECT_EQ(host.water.getNumParticles(), 128);
  EXPECT_EQ(host.water.carried_by(*host.sheet), 128);
  for (int i = 0; i < host.water.getNumParticles(); ++i) EXPECT_GT(host.water.getPosition(i).y(), 10);
}

TEST(Drivers, pins_of_a_soft_sheet_torn_ten_metres_away_and_back) {
  Soft host(btVector3(0, 0, 0), 12);
  btSoftBody* cloth = host.cloth();
  host.pour(0.01);
  RUN(host.step());
  for (const btScalar y : {btScalar(10), btScalar(-10), btScalar(-10), btScalar(10)}) {
    for (int i = 0; i < cloth->m_nodes.size(); ++i)
      if (cloth->m_nodes[i].m_im == 0) cloth->m_nodes[i].m_x += btVector3(0, y, 0);
    RUN(host.step());
  }
  EXPECT_GT(host.water.contacts, 32u);
  EXPECT_GT(host.water.summary().pairs, 1000u);
}

TEST(Drivers, nodes_driven_by_velocities) {
  Dragged host(2);
  // Bullet integrates nodes of mass 0, too.
  for (int i = 0; i < host.sheet->m_nodes.size(); ++i) host.sheet->m_nodes[i].m_v = btVector3(0, 5, 0);
  for (int i = 0; i < 20; ++i) RUN(host.step());
  EXPECT_NEAR(middle(*host.sheet), 0.1, 1e-4);
  EXPECT_GT(host.water.contacts, 64u);
  for (const Vec3& v : host.water.getWorld().velocities()) EXPECT_GT(v.y(), 2);
  for (const Vec3& x : host.water.getWorld().positions()) EXPECT_GT(x.y(), 0.1);
}

TEST(Drivers, a_free_sheet_thrown_by_set_velocity) {
  Soft host(btVector3(0, 0, 0));
  btSoftBody* cloth = host.bullet.patch(nodes_across, 0.4, 0, 0, 2);
  ASSERT_TRUE(host.solver.addCloth(cloth, h).ok());
  host.pour(0.02);
  for (int i = 0; i < 100; ++i) {
    if (i == 10) cloth->setVelocity(btVector3(0, 40, 0));
    if (i == 30) cloth->setVelocity(btVector3(0, -3, 0));
    RUN(host.step());
  }
  EXPECT_GT(host.water.contacts, 64u);
  EXPECT_GT(host.water.getWorld().report().momentum_after.y(), 1) << "the water was thrown up";
}

struct SubSteps {
  double frame;
  int maximum;
  double fixed;
  bool holds;  ///< Bullet's cloth bears the load at this length
};

class BulletsSubSteps : public ::testing::TestWithParam<SubSteps> {};

TEST_P(BulletsSubSteps, nothing_crosses_and_the_water_stays) {
  const SubSteps s = GetParam();
  Soft host;
  btSoftBody* cloth = host.bowl();
  host.pour(0);
  int sub_steps = 0;
  const double simulated_of_a_frame = s.maximum == 0 ? s.frame : std::min(s.frame, s.maximum * s.fixed);
  const int frames = static_cast<int>(std::lround(0.4 / simulated_of_a_frame));
  for (int i = 0; i < frames; ++i) {
    const int n = host.bullet.world.stepSimulation(bt(s.frame), s.maximum, bt(s.fixed));
    sub_steps += s.maximum == 0 ? 1 : std::min(n, s.maximum);
    if (sub_steps == 0) continue;
    RUN(host.water.expect_sound(host.solver.getReport()));
  }
  EXPECT_EQ(host.water.getWorld().step_count(), static_cast<std::uint64_t>(sub_steps))
      << "one coupling for each of Bullet's sub-steps";
  EXPECT_EQ(host.water.summary().records, static_cast<std::uint64_t>(sub_steps));
  EXPECT_GT(host.water.contacts, 20u);
  if (!s.holds) return;
  EXPECT_EQ(host.water.carried_by(*cloth), 128);
}

INSTANTIATE_TEST_SUITE_P(Lengths, BulletsSubSteps,
                         ::testing::Values(SubSteps{1. / 60, 0, 0, false},          // one step a frame
                                           SubSteps{1. / 60, 1, 1. / 60, false},    // Bullet's defaults
                                           SubSteps{1. / 60, 20, 1. / 960, true},   // as advised
                                           SubSteps{1. / 60, 4, 1. / 960, true},    // time is lost
                                           SubSteps{1. / 240, 0, 0, false},         //
                                           SubSteps{1. / 240, 8, 1. / 1920, true},  //
                                           SubSteps{0.001, 1, 0.001, true}));

}  // namespace
}  // namespace oilskin::bullet
