// A jet of water on a cloth in a Bullet world: the smallest complete program.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cstdio>

#include "oilskin/bullet.h"

namespace {

// A square cloth of 21 × 21 nodes, 30 g, pinned at its four corners.
btSoftBody* make_cloth(btSoftBodyWorldInfo& world_info) {
  const btScalar r = btScalar(0.15);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world_info, {-r, 0, -r}, {r, 0, -r}, {-r, 0, r},
                                                     {r, 0, r}, 21, 21, 1 + 2 + 4 + 8, true);
  cloth->setTotalMass(btScalar(0.03));
  cloth->m_cfg.piterations = 10;
  cloth->getCollisionShape()->setMargin(btScalar(0.005));
  return cloth;
}

bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

}  // namespace

int main() {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver solver;  // is a btDefaultSoftBodySolver
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);
  btSoftBody* cloth = make_cloth(world.getWorldInfo());
  world.addSoftBody(cloth);

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  if (!accepted(solver.addFluid(&water))) return 1;
  if (!accepted(solver.addCloth(cloth, btScalar(0.001) /* thickness [m] */))) return 1;
  if (!accepted(water.addJet({0, btScalar(0.1), 0}, {0, -1, 0}, btScalar(1.5), btScalar(0.03)))) return 1;

  btScalar lowest = 0;
  for (int frame = 0; frame < 12; ++frame) {
    world.stepSimulation(btScalar(1. / 60), 40, btScalar(0.0005));
    for (int i = 0; i < water.getNumParticles(); ++i) lowest = std::min(lowest, water.getPosition(i).y());
  }
  const oilskin::StepReport& report = solver.getReport();  // of the last coupled step
  std::printf("%d particles, %llu contacts, lowest at %.3f m\n", water.getNumParticles(),
              static_cast<unsigned long long>(report.contact.contacts), static_cast<double>(lowest));
  const bool holds = accepted(report.status) && water.getNumParticles() > 0 && report.contact.contacts > 0;

  solver.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
  return holds ? 0 : 1;
}
