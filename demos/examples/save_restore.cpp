// A saved game: water and cloth as bytes. Restored into new objects, both go on bit for bit.
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

  std::vector<std::uint8_t> bytes;
  if (!accepted(played.softSolver.saveState(&bytes))) return 1;

  // Restored into objects that were built in the same way.
  Game loaded;
  if (!loaded.create() || !accepted(loaded.softSolver.restoreState(bytes))) return 1;

  const int before = loaded.water.getNumParticles();
  for (int i = 0; i < 10; ++i)
    if (played.run(10) != loaded.run(10)) return std::printf("differs after step %d\n", 10 * i), 1;
  std::printf("%zu bytes hold %d particles; 100 steps later both games have the same %d\n", bytes.size(),
              before, loaded.water.getNumParticles());
  return before > 0 && loaded.water.getNumParticles() > before ? 0 : 1;
}
