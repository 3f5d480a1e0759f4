// A Bullet user saves the fluid's world and the nodes of the cloth, and goes on with new bodies
// (docs/manual/saving.md).
#include <gtest/gtest.h>

#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet {
namespace {

using namespace test;

/// Water on a pinned patch over a plane, all of it Bullet's but the water.
class Scene {
 public:
  Scene()
      : bullet(btVector3(0, bt(-9.81), 0), &solver),
        water(coarse_fluid(PressureSolver::dfsph), small_world(), ContactSettings{}) {
    cloth = bullet.patch(11, 0.4, 0, 15);
    ground.setCollisionShape(&plane);
    EXPECT_TRUE(solver.addFluid(&water).ok());
    EXPECT_TRUE(solver.addCloth(cloth, bt(0.002)).ok());
    EXPECT_TRUE(solver.addCollisionObject(&ground, bt(0.004)).ok());
  }
  ~Scene() { solver.removeFluid(&water); }

  std::uint64_t run(int steps) {
    for (int k = 0; k < steps; ++k) bullet.step(1.0 / 500);
    return water.getWorld().state_hash();
  }
  std::vector<btSoftBody::Node> nodes() const {
    std::vector<btSoftBody::Node> all;
    for (int i = 0; i < cloth->m_nodes.size(); ++i) all.push_back(cloth->m_nodes[i]);
    return all;
  }
  void set_nodes(const std::vector<btSoftBody::Node>& saved) {
    // Rest lengths are those of the body as built: Bullet would measure them in its first step.
    cloth->updateConstants();
    cloth->m_bUpdateRtCst = false;
    for (int i = 0; i < cloth->m_nodes.size(); ++i) {
      btSoftBody::Node& n = cloth->m_nodes[i];
      const btSoftBody::Node& from = saved[static_cast<std::size_t>(i)];
      n.m_x = from.m_x, n.m_q = from.m_q, n.m_v = from.m_v, n.m_vn = from.m_vn, n.m_f = from.m_f;
      n.m_n = from.m_n, n.m_im = from.m_im;
    }
    cloth->updateNormals();
    cloth->updateBounds();
  }

  btFluidSoftBodySolver solver;
  SoftWorld bullet;
  btFluid water;
  btSoftBody* cloth = nullptr;
  btStaticPlaneShape plane{btVector3(0, 1, 0), bt(-0.2)};
  btCollisionObject ground;
};

TEST(Save, a_bullet_user_goes_on_with_new_bodies) {
  Scene scene;
  ASSERT_TRUE(
      scene.water.addBox({bt(-0.1), bt(0.02), bt(-0.1)}, {bt(0.1), bt(0.12), bt(0.1)}, {0, -1, 0}).ok());
  ASSERT_TRUE(scene.water.addJet({bt(0.3), bt(0.1), 0}, {-1, 0, 0}, 1, bt(0.03)).ok());
  scene.run(40);
  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(scene.water.getWorld().save(&saved).ok());
  const std::vector<btSoftBody::Node> nodes = scene.nodes();
  const int particles = scene.water.getNumParticles();

  Scene again;
  again.set_nodes(nodes);
  const Status status = again.water.getWorld().restore(saved);
  ASSERT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(again.water.getWorld().state_hash(), scene.water.getWorld().state_hash());
  EXPECT_EQ(again.water.getNumParticles(), particles);
  for (int k = 0; k < 50; ++k) ASSERT_EQ(again.run(1), scene.run(1)) << "step " << k;
  EXPECT_GT(scene.water.getNumParticles(), particles);
  EXPECT_NE(again.solver.getCoupling().getSurface(again.cloth), nullptr);
}

}  // namespace
}  // namespace oilskin::bullet
