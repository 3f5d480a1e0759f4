// For engines that own their btSoftRigidDynamicsWorld: no solver of Oilskin's in the world, a btFluidCoupling
// beside it, and one call of step() after stepSimulation().
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>

#include "oilskin/bullet.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

int main() {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);
  world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);

  // A cloth of 0.3 m × 0.3 m and 30 g that hangs on its four corners.
  const btScalar r = btScalar(0.15);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r},
                                                     {-r, 0, r}, {r, 0, r}, 21, 21, 1 + 2 + 4 + 8, true);
  cloth->setTotalMass(btScalar(0.03));
  cloth->m_cfg.piterations = 10;
  cloth->getCollisionShape()->setMargin(btScalar(0.005));
  world.addSoftBody(cloth);

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  oilskin::bullet::btFluidCoupling coupling(&water);
  if (!accepted(coupling.addCloth(cloth, btScalar(0.001))) ||  // thickness [m]
      !accepted(water.addJet({0, btScalar(0.1), 0}, {0, -1, 0}, btScalar(1.5), btScalar(0.03))))
    return 1;

  const btScalar subStep = btScalar(1. / 1000);  // [s]
  int subSteps = 0;
  unsigned long long contacts = 0;
  btScalar pull = 0;  // impulse of the water on the cloth, downwards [N s]
  for (int frame = 0; frame < 100; ++frame) {
    const int n = world.stepSimulation(btScalar(1. / 240), 10, subStep);
    // The time that the cloth has moved, not that of the frame: Bullet keeps what is left of it for the next.
    const oilskin::StepReport& report = coupling.step(btScalar(n) * subStep);
    if (!accepted(report.status)) return 1;
    subSteps += n;
    contacts += report.contact.contacts;
    for (const oilskin::Vec3& impulse : *coupling.getNodeImpulses(cloth)) pull -= btScalar(impulse.y());
  }

  std::printf("%d particles after %.3f s, %llu contacts, the cloth got %.3g N s downwards\n",
              water.getNumParticles(), water.getWorld().time(), contacts, double(pull));
  const bool in_step = btFabs(btScalar(water.getWorld().time()) - btScalar(subSteps) * subStep) < subStep;
  const int particles = water.getNumParticles();

  coupling.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
  return in_step && particles > 0 && contacts > 0 && pull > 0 ? 0 : 1;
}
