// The example of the README, run as a test. What is between the two marks is quoted there.
// [example]
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>

#include "oilskin/bullet.h"

int main() {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver softSolver;  // is a btDefaultSoftBodySolver
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &softSolver);
  world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);

  const btScalar r = btScalar(0.15);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r},
                                                     {-r, 0, r}, {r, 0, r}, 21, 21, 1 + 2 + 4 + 8, true);
  cloth->setTotalMass(btScalar(0.03));
  cloth->m_cfg.piterations = 10;
  cloth->getCollisionShape()->setMargin(btScalar(0.005));
  world.addSoftBody(cloth);

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  for (const oilskin::Status& status :
       {softSolver.addFluid(&water), softSolver.addCloth(cloth, btScalar(0.001) /* thickness [m] */),
        water.addJet({0, btScalar(0.1), 0}, {0, -1, 0}, btScalar(1.5), btScalar(0.03))})
    if (!status.ok()) return std::printf("refused: %s\n", status.message.c_str());

  for (int frame = 0; frame < 12; ++frame) {
    world.stepSimulation(btScalar(1. / 60), 40, btScalar(0.0005));
    for (int i = 0; i < water.getNumParticles(); ++i) { /* draw(water.getPosition(i)); */
    }
  }
  std::printf("%d particles, %llu contacts\n", water.getNumParticles(),
              static_cast<unsigned long long>(softSolver.getReport().contact.contacts));

  softSolver.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
  // [example]
  return water.getNumParticles() > 0 && softSolver.getReport().status.ok() ? 0 : 1;
}
