// A saved game: the fluid's world as bytes, the cloth's nodes as Bullet has them. Restored into new objects,
// the water goes on bit for bit.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>

#include "oilskin/bullet.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// A cloth that hangs on its corners, and water that knows it.
struct Game {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver softSolver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &constraints, &configuration, &softSolver};
  oilskin::bullet::btFluid water{btScalar(0.01)};  // rest distance of the particles [m]
  btSoftBody* cloth = nullptr;

  bool create() {
    world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);
    const btScalar r = btScalar(0.15);
    cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r}, {-r, 0, r},
                                           {r, 0, r}, 21, 21, 1 + 2 + 4 + 8, true);
    cloth->setTotalMass(btScalar(0.03));
    cloth->getCollisionShape()->setMargin(btScalar(0.005));
    world.addSoftBody(cloth);
    return accepted(softSolver.addFluid(&water)) && accepted(softSolver.addCloth(cloth, btScalar(0.001)));
  }
  ~Game() {
    softSolver.removeCloth(cloth);
    world.removeSoftBody(cloth);
    delete cloth;
  }
  std::uint64_t run(int steps) {
    for (int i = 0; i < steps; ++i) world.stepSimulation(btScalar(0.001), 0);
    return water.getWorld().state_hash();  // over the bits of all particles and nodes
  }
};

int main() {
  Game played;
  if (!played.create() ||
      !accepted(played.water.addJet({0, btScalar(0.1), 0}, {0, -1, 0}, 1, btScalar(0.03))))
    return 1;
  played.run(150);

  // Save.
  std::vector<std::uint8_t> bytes;
  if (!accepted(played.water.getWorld().save(&bytes))) return 1;
  std::vector<btSoftBody::Node> nodes;
  nodes.reserve(std::size_t(played.cloth->m_nodes.size()));
  for (int i = 0; i < played.cloth->m_nodes.size(); ++i) nodes.push_back(played.cloth->m_nodes[i]);

  // Restore: build the same cloth, give it its nodes back, then the water.
  Game loaded;
  if (!loaded.create()) return 1;
  btSoftBody& cloth = *loaded.cloth;
  cloth.updateConstants();       // rest lengths are those of the cloth as built;
  cloth.m_bUpdateRtCst = false;  // Bullet would measure them again in its first step
  for (int i = 0; i < cloth.m_nodes.size(); ++i) {
    btSoftBody::Node& node = cloth.m_nodes[i];
    const btSoftBody::Node& from = nodes[std::size_t(i)];
    node.m_x = from.m_x, node.m_q = from.m_q, node.m_v = from.m_v, node.m_vn = from.m_vn;
    node.m_f = from.m_f, node.m_n = from.m_n, node.m_im = from.m_im;
  }
  cloth.updateNormals();
  cloth.updateBounds();
  if (!accepted(loaded.water.getWorld().restore(bytes))) return 1;

  const int before = loaded.water.getNumParticles();
  for (int i = 0; i < 10; ++i)
    if (played.run(10) != loaded.run(10)) return std::printf("differs after step %d\n", 10 * i), 1;
  std::printf("%zu bytes hold %d particles; 100 steps later both games have the same %d\n", bytes.size(),
              before, loaded.water.getNumParticles());
  return before > 0 && loaded.water.getNumParticles() > before ? 0 : 1;
}
