#include "bullet_adapter/soft_body_host.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "bullet_world.h"

namespace oilskin::bullet {
namespace {

using namespace test;

TEST(SoftBodyHost, first_gather_describes_the_body) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 1, 0.3, 1);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  const Gathered gathered = host.gather(0, motion);
  ASSERT_TRUE(gathered.status.ok()) << gathered.status.message;
  EXPECT_TRUE(gathered.new_surface);
  EXPECT_EQ(motion.storage, is_double ? Storage::float64 : Storage::float32);
  EXPECT_FALSE(motion.nodes_movable);
  ASSERT_EQ(motion.x_t1.size(), 25u);
  EXPECT_EQ(motion.triangles.size(), static_cast<std::size_t>(cloth->m_faces.size()));
  for (std::size_t i = 0; i < 25; ++i) {
    const btSoftBody::Node& node = cloth->m_nodes[static_cast<int>(i)];
    EXPECT_EQ(motion.x_t1[i], to_vec3(node.m_x));
    EXPECT_EQ(motion.x_t1[i], stored(motion.x_t1[i], motion.storage));
    EXPECT_EQ(motion.inverse_mass[i], static_cast<double>(node.m_im));
    EXPECT_EQ(motion.holdable[i], node.m_im == 0);
  }
  for (std::size_t f = 0; f < motion.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(&cloth->m_nodes[static_cast<int>(motion.triangles[f][k])],
                cloth->m_faces[static_cast<int>(f)].m_n[k]);
}

TEST(SoftBodyHost, impulses_persist_and_nothing_else_changes) {
  for (int iterations : {1, 10}) {
    SoftWorld bullet;
    btSoftBody* cloth = bullet.patch(9, 0.4);
    cloth->m_cfg.piterations = iterations;
    int user = 0;
    cloth->setUserPointer(&user);
    cloth->m_tag = &user;
    for (int i = 0; i < 3; ++i) bullet.step(0.001);  // constants are up to date
    std::vector<btScalar> rest, im;
    for (int i = 0; i < cloth->m_links.size(); ++i) rest.push_back(cloth->m_links[i].m_rl);
    for (int i = 0; i < cloth->m_nodes.size(); ++i) im.push_back(cloth->m_nodes[i].m_im);

    SoftBodyHost host(cloth, {});
    SurfaceMotion motion;
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, 1e-5);
    Vec3 given = momentum(*cloth);
    for (int step = 0; step < 400; ++step) {
      bullet.step(0.001);
      ASSERT_TRUE(gather_step(host, 0.001, motion).status.ok());
      for (int k = 0; k < 20; ++k) {
        const Vec3 j(normal(random), normal(random) + 1e-5, normal(random));
        motion.impulse[random() % motion.impulse.size()] += j;
        given += j;
      }
      const auto x = motion.x_t1;
      host.scatter(motion);
      EXPECT_EQ(motion.x_t1, x) << "positions are not touched";
    }
    EXPECT_LT((momentum(*cloth) - given).norm(), (is_double ? 1e-12 : 1e-4) * given.norm());
    for (int i = 0; i < cloth->m_links.size(); ++i) ASSERT_EQ(cloth->m_links[i].m_rl, rest[std::size_t(i)]);
    for (int i = 0; i < cloth->m_nodes.size(); ++i) ASSERT_EQ(cloth->m_nodes[i].m_im, im[std::size_t(i)]);
    EXPECT_EQ(cloth->getUserPointer(), &user);
    EXPECT_EQ(cloth->m_tag, &user);
    EXPECT_EQ(host.node_impulses().size(), static_cast<std::size_t>(cloth->m_nodes.size()));
  }
}

TEST(SoftBodyHost, moved_positions_persist_without_momentum) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  bullet.step(0.001);
  ASSERT_TRUE(gather_step(host, 0.001, motion).status.ok());
  const Vec3 before = momentum(*cloth);
  const Vec3 target = stored(motion.x_t1[12] + Vec3(0, 1e-4, 0), motion.storage);
  motion.x_t1[12] = target;
  motion.moved[12] = 1;
  motion.x_t1[13] += Vec3(0, 1, 0);  // not flagged: ignored, and reported back as it is
  host.scatter(motion);
  EXPECT_EQ(to_vec3(cloth->m_nodes[12].m_x), target);
  EXPECT_EQ(motion.x_t1[12], target);
  EXPECT_EQ(motion.x_t1[13], to_vec3(cloth->m_nodes[13].m_x));
  EXPECT_EQ(momentum(*cloth), before);
  for (int i = 0; i < 5; ++i) bullet.step(0.001);
  EXPECT_LT((momentum(*cloth) - before).norm(), is_double ? 1e-14 : 1e-6);
}

TEST(SoftBodyHost, start_of_a_step_is_the_end_of_the_last) {
  SoftWorld bullet(btVector3(0, bt(-9.81), 0));
  btSoftBody* cloth = bullet.patch(7, 0.4, 0, 15);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  ASSERT_TRUE(gather_step(host, 0, motion).new_surface);
  for (int step = 0; step < 20; ++step) {
    bullet.step(0.001);
    const auto end = motion.x_t1;
    ASSERT_FALSE(gather_step(host, 0.001, motion).new_surface);
    EXPECT_EQ(motion.x_t0, end);
    host.scatter(motion);
  }
}

TEST(SoftBodyHost, pins_moved_by_hand_have_the_velocity_of_their_motion) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4, 0, 1);
  int pin = 0;
  while (cloth->m_nodes[pin].m_im != 0) ++pin;
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  ASSERT_TRUE(gather_step(host, 0, motion).status.ok());
  bullet.step(0.001);
  cloth->m_nodes[pin].m_x += btVector3(0, bt(0.25), 0);
  ASSERT_FALSE(gather_step(host, 0.5, motion).new_surface);
  const auto p = static_cast<std::size_t>(pin);
  EXPECT_NEAR(motion.velocity[p].y(), 0.5, 1e-6);
  EXPECT_NEAR((motion.x_t1[p] - motion.x_t0[p]).y(), 0.25, 1e-6) << "the motion is swept";
  EXPECT_EQ(cloth->m_nodes[pin].m_v, btVector3(0, 0, 0)) << "reading changes nothing";
  host.scatter(motion);
  cloth->m_nodes[pin].m_x += btVector3(0, 1, 0);
  host.forget_motion();
  ASSERT_TRUE(gather_step(host, 0.5, motion).status.ok());
  EXPECT_EQ(motion.velocity[p], Vec3(0, 0, 0)) << "a teleport is no motion";
}

TEST(SoftBodyHost, pins_move_only_when_they_are_held) {
  for (bool may_hold : {true, false}) {
    SoftWorld bullet;
    btSoftBody* cloth = bullet.patch(5, 0.4, 0, 1);
    int pin = 0;
    while (cloth->m_nodes[pin].m_im != 0) ++pin;
    const auto p = static_cast<std::size_t>(pin);
    SoftBodyHost::Options options;
    options.may_hold_pins = may_hold;
    SoftBodyHost host(cloth, options);
    SurfaceMotion motion;
    ASSERT_TRUE(gather_step(host, 0, motion).status.ok());
    cloth->m_nodes[pin].m_x += btVector3(0, bt(0.25), 0);
    cloth->m_nodes[pin].m_v = btVector3(0, 1, 0);
    ASSERT_TRUE(gather_step(host, 0.5, motion).status.ok());
    EXPECT_EQ(motion.holdable[p], may_hold);
    motion.impulse[p] = Vec3(0, -1, 0);  // the reaction: booked, not applied
    motion.x_t1[p] = motion.x_t0[p];
    motion.moved[p] = 1;
    host.scatter(motion);
    EXPECT_EQ(host.node_impulses()[p], Vec3(0, -1, 0));
    EXPECT_EQ(to_vec3(cloth->m_nodes[pin].m_x) == motion.x_t0[p], may_hold);
    EXPECT_EQ(motion.x_t1[p], to_vec3(cloth->m_nodes[pin].m_x)) << "what is stored is told";
    EXPECT_EQ(cloth->m_nodes[pin].m_v, may_hold ? btVector3(0, 0, 0) : btVector3(0, 1, 0));
  }
}

TEST(SoftBodyHost, refuses_bodies_without_faces_and_names_bad_nodes) {
  SoftWorld bullet;
  btSoftBody* rope = bullet.own(btSoftBodyHelpers::CreateRope(bullet.world.getWorldInfo(), btVector3(0, 0, 0),
                                                              btVector3(1, 0, 0), 8, 0));
  SurfaceMotion motion;
  EXPECT_NE(SoftBodyHost(rope, {}).gather(0, motion).status.message.find("no faces"), std::string::npos);

  btSoftBody* cloth = bullet.patch(5, 0.4);
  SoftBodyHost host(cloth, {});
  ASSERT_TRUE(gather_step(host, 0, motion).status.ok());
  cloth->m_nodes[17].m_x.setY(std::numeric_limits<btScalar>::quiet_NaN());
  EXPECT_NE(host.gather(0.1, motion).status.message.find("node 17"), std::string::npos);
  cloth->m_nodes[17].m_x.setY(0);
  cloth->m_nodes[3].m_v.setX(std::numeric_limits<btScalar>::infinity());
  EXPECT_NE(host.gather(0.1, motion).status.message.find("node 3"), std::string::npos);
}

TEST(SoftBodyHost, changed_bodies_are_new_surfaces) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  auto is_new = [&] {
    const Gathered gathered = gather_step(host, 0.001, motion);
    EXPECT_TRUE(gathered.status.ok()) << gathered.status.message;
    EXPECT_EQ(motion.triangles.size(), static_cast<std::size_t>(cloth->m_faces.size()));
    EXPECT_EQ(motion.x_t1.size(), static_cast<std::size_t>(cloth->m_nodes.size()));
    host.scatter(motion);
    return gathered.new_surface;
  };
  EXPECT_TRUE(is_new());
  EXPECT_FALSE(is_new());
  cloth->appendNode(btVector3(3, 3, 3), bt(0.01));
  EXPECT_TRUE(is_new());
  cloth->appendFace(0, 1, cloth->m_nodes.size() - 1);
  EXPECT_TRUE(is_new());
  EXPECT_FALSE(is_new());
  cloth->m_faces.swap(0, 1);
  EXPECT_TRUE(is_new());
  cloth->m_faces.pop_back();
  EXPECT_TRUE(is_new());
  EXPECT_FALSE(is_new());
}

TEST(SoftBodyHost, scatter_into_a_body_that_changed_since_gather_is_harmless) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  motion.impulse[0] = Vec3(1, 0, 0);
  cloth->appendNode(btVector3(3, 3, 3), bt(0.01));
  host.scatter(motion);
  EXPECT_EQ(momentum(*cloth), Vec3(0, 0, 0));
}

TEST(SoftBodyHost, bodies_that_are_not_simulated_are_prescribed) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  cloth->forceActivationState(DISABLE_SIMULATION);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  for (double im : motion.inverse_mass) EXPECT_EQ(im, 0);
}

TEST(SoftBodyHost, sleepers_are_woken_by_impulses_only) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(5, 0.4);
  cloth->forceActivationState(ISLAND_SLEEPING);
  SoftBodyHost host(cloth, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  host.scatter(motion);
  EXPECT_FALSE(cloth->isActive());
  gather_step(host, 0.001, motion);
  motion.impulse[7] = Vec3(0, 1e-6, 0);
  host.scatter(motion);
  EXPECT_TRUE(cloth->isActive());
}

/// Two triangles side by side with copies of the shared edge: nodes 1, 2 and 3, 4.
btSoftBody* unwelded_pair(SoftWorld& bullet) {
  const btVector3 x[6] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
  const btScalar m[6] = {1, 1, 2, 3, 2, 1};
  auto* body = new btSoftBody(&bullet.world.getWorldInfo(), 6, x, m);
  body->appendFace(0, 1, 2);
  body->appendFace(3, 5, 4);
  return bullet.own(body);
}

TEST(SoftBodyHostWelding, coincident_nodes_are_one_contact_node) {
  SoftWorld bullet;
  btSoftBody* body = unwelded_pair(bullet);
  body->m_nodes[1].m_v = btVector3(0, 4, 0);
  SoftBodyHost host(body, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  ASSERT_EQ(motion.x_t1.size(), 4u);
  EXPECT_EQ(motion.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(motion.triangles[1], (Triangle{1, 3, 2}));
  EXPECT_NEAR(motion.inverse_mass[1], 0.25, 1e-6);
  EXPECT_NEAR(motion.velocity[1].y(), 1, 1e-6) << "weighted by mass";
  motion.impulse[1] = Vec3(8, 0, 0);
  motion.x_t1[1] = stored(Vec3(1, 0.125, 0), motion.storage);
  motion.moved[1] = 1;
  host.scatter(motion);
  for (int copy : {1, 3}) {
    EXPECT_NEAR(static_cast<double>(body->m_nodes[copy].m_v.x()), 2, 1e-6);
    EXPECT_NEAR(static_cast<double>(body->m_nodes[copy].m_v.y()), 1, 1e-6) << "momentum is kept";
    EXPECT_EQ(to_vec3(body->m_nodes[copy].m_x), Vec3(1, 0.125, 0));
  }
  EXPECT_NEAR(host.node_impulses()[1].x(), 2, 1e-6);
  EXPECT_NEAR(host.node_impulses()[3].x(), 6, 1e-6);
  EXPECT_FALSE(gather_step(host, 0.001, motion).new_surface) << "still together";
}

TEST(SoftBodyHostWelding, copies_that_bullet_moves_apart_are_joined_at_their_centre_of_mass) {
  SoftWorld bullet;
  btSoftBody* body = unwelded_pair(bullet);
  SoftBodyHost host(body, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  host.scatter(motion);
  const Vec3 before = motion.x_t1[1];
  body->m_nodes[3].m_x += btVector3(0, bt(0.5), 0);  // mass 3 of 4
  EXPECT_FALSE(gather_step(host, 0.001, motion).new_surface);
  EXPECT_EQ(motion.x_t0[1], before);
  EXPECT_EQ(motion.x_t1[1], Vec3(1, 0.375, 0));
  const auto certified = motion.x_t1;
  host.scatter(motion);
  EXPECT_EQ(motion.x_t1, certified);
  for (int copy : {1, 3}) EXPECT_EQ(to_vec3(body->m_nodes[copy].m_x), Vec3(1, 0.375, 0));
}

/// Two patches of 6 × 6 nodes that share the coordinates of an edge and nothing else; their outer edges are
/// pinned.
btSoftBody* unwelded_patches(SoftWorld& bullet) {
  const int n = 6;
  std::vector<btVector3> x;
  std::vector<btScalar> mass;
  for (int patch = 0; patch < 2; ++patch)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        x.emplace_back(bt(0.1) * bt(patch ? i : i - (n - 1)), btScalar(0), bt(0.1) * bt(j));
        mass.push_back(i == (patch ? n - 1 : 0) ? btScalar(0) : bt(0.01));
      }
  auto* body =
      new btSoftBody(&bullet.world.getWorldInfo(), static_cast<int>(x.size()), x.data(), mass.data());
  for (int patch = 0; patch < 2; ++patch)
    for (int i = 0; i + 1 < n; ++i)
      for (int j = 0; j + 1 < n; ++j) {
        const int a = (patch * n + i) * n + j;
        body->appendFace(a, a + 1, a + n);
        body->appendFace(a + 1, a + n + 1, a + n);
        for (const auto& [p, q] : {std::pair(a, a + 1), std::pair(a, a + n), std::pair(a + 1, a + n),
                                   std::pair(a + 1, a + n + 1), std::pair(a + n, a + n + 1)})
          body->appendLink(p, q, nullptr, true);
      }
  body->m_cfg.piterations = 10;
  return bullet.own(body);
}

TEST(SoftBodyHostWelding, a_seam_under_load_stays_closed) {
  SoftWorld bullet(btVector3(0, bt(-9.81), 0));
  btSoftBody* body = unwelded_patches(bullet);
  SoftBodyHost host(body, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  ASSERT_EQ(motion.x_t1.size(), 66u);
  for (int step = 0; step < 1000; ++step) {
    bullet.step(0.001);
    ASSERT_FALSE(gather_step(host, 0.001, motion).new_surface);
    host.scatter(motion);
    for (int j = 0; j < 6; ++j) ASSERT_EQ(body->m_nodes[30 + j].m_x, body->m_nodes[36 + j].m_x);
  }
  for (int j = 0; j < 6; ++j) {
    EXPECT_LT(std::abs(body->m_nodes[30 + j].m_x.x()), bt(0.05)) << "held from both sides";
    EXPECT_GT(body->m_nodes[30 + j].m_x.y(), bt(-0.3));
  }
  double speed = 0;
  for (int i = 0; i < body->m_nodes.size(); ++i)
    speed = std::max(speed, to_vec3(body->m_nodes[i].m_v).norm());
  EXPECT_LT(speed, 3) << "sewing feeds no energy";
}

TEST(SoftBodyHostWelding, pinned_copies_that_are_dragged_apart_become_nodes_of_their_own) {
  SoftWorld bullet;
  btSoftBody* body = unwelded_pair(bullet);
  body->m_nodes[1].m_im = body->m_nodes[3].m_im = 0;
  SoftBodyHost host(body, {});
  SurfaceMotion motion;
  gather_step(host, 0, motion);
  const Vec3 was = motion.x_t1[1];
  host.scatter(motion);
  body->m_nodes[1].m_x += btVector3(0, bt(0.25), 0);
  body->m_nodes[3].m_x += btVector3(0, bt(0.25), 0);
  EXPECT_FALSE(gather_step(host, 0.001, motion).new_surface) << "dragged together";
  host.scatter(motion);
  body->m_nodes[3].m_x = to_bt(was);
  motion.x_t0 = motion.x_t1;
  ASSERT_TRUE(host.gather(0.001, motion).new_surface);
  ASSERT_EQ(motion.x_t1.size(), 5u);
  ASSERT_EQ(motion.x_t0.size(), 5u);
  EXPECT_EQ(motion.x_t0[motion.triangles[0][1]], motion.x_t0[motion.triangles[1][0]]);
  EXPECT_EQ(motion.x_t1[motion.triangles[1][0]], was);
  EXPECT_EQ(motion.triangles[0][2], motion.triangles[1][2]) << "the other end is still one node";
  EXPECT_FALSE(gather_step(host, 0.001, motion).new_surface);
}

TEST(SoftBodyHostWelding, a_pinned_copy_pins_all_and_welding_can_be_off) {
  SoftWorld bullet;
  btSoftBody* body = unwelded_pair(bullet);
  body->m_nodes[3].m_im = 0;
  SurfaceMotion motion;
  SoftBodyHost welded(body, {});
  gather_step(welded, 0, motion);
  EXPECT_EQ(motion.inverse_mass[1], 0);
  EXPECT_EQ(motion.holdable[1], 1);
  body->m_nodes[1].m_x += btVector3(0, bt(0.5), 0);  // the free copy follows the pin
  gather_step(welded, 0.001, motion);
  EXPECT_EQ(motion.x_t1[1], Vec3(1, 0, 0));
  welded.scatter(motion);
  EXPECT_EQ(to_vec3(body->m_nodes[1].m_x), Vec3(1, 0, 0));
  SoftBodyHost::Options off;
  off.weld = false;
  SoftBodyHost apart(body, off);
  SurfaceMotion other;
  gather_step(apart, 0, other);
  EXPECT_EQ(other.x_t1.size(), 6u);
}

}  // namespace
}  // namespace oilskin::bullet
