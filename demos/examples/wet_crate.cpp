// A crate falls on a cloth on which a jet of water falls, too. Bullet moves the crate and the cloth and lets
// them touch; the water pushes both.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cstdio>

#include "oilskin/bullet.h"

namespace {

// A square cloth of 33 × 33 nodes, 50 g; at each corner 3 × 3 nodes are pinned, since one would give way.
btSoftBody* make_cloth(btSoftBodyWorldInfo& world_info) {
  constexpr int n = 33;
  const btScalar r = btScalar(0.2);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world_info, {-r, 0, -r}, {r, 0, -r}, {-r, 0, r},
                                                     {r, 0, r}, n, n, 0, true);
  cloth->setTotalMass(btScalar(0.05));
  for (const int row : {0, 1, 2, n - 3, n - 2, n - 1})
    for (const int column : {0, 1, 2, n - 3, n - 2, n - 1}) cloth->setMass(row * n + column, 0);
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
  oilskin::bullet::btFluidSoftBodySolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);
  btSoftBody* cloth = make_cloth(world.getWorldInfo());
  world.addSoftBody(cloth);

  btBoxShape shape(btVector3(btScalar(0.03), btScalar(0.03), btScalar(0.03)));
  shape.setMargin(btScalar(0.001));  // not more than the thickness
  btVector3 inertia;
  const btScalar mass = btScalar(0.06);
  shape.calculateLocalInertia(mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
  info.m_startWorldTransform.setOrigin({btScalar(0.07), btScalar(0.35), btScalar(0.02)});
  btRigidBody crate(info);
  world.addRigidBody(&crate);

  const btScalar thickness = btScalar(0.002);
  oilskin::bullet::btFluid water(btScalar(0.01));
  if (!accepted(solver.addFluid(&water))) return 1;
  if (!accepted(solver.addCloth(cloth, thickness))) return 1;
  if (!accepted(solver.addRigidBody(&crate, thickness))) return 1;
  if (!accepted(water.addJet({0, btScalar(0.2), 0}, {0, -1, 0}, 1, btScalar(0.03)))) return 1;

  btScalar fastest = 0, lowest = 1;
  for (int frame = 0; frame < 30; ++frame) {
    world.stepSimulation(btScalar(1. / 60), 20, btScalar(0.001));
    fastest = std::max(fastest, crate.getLinearVelocity().length());
    lowest = std::min(lowest, crate.getWorldTransform().getOrigin().y());
  }
  for (const std::string& message : solver.takeMessages()) std::printf("%s\n", message.c_str());
  std::printf("%d particles; the crate sank to %.3f m and was never faster than %.1f m/s\n",
              water.getNumParticles(), static_cast<double>(lowest), static_cast<double>(fastest));
  // It falls at 2.6 m/s; the cloth, at 0, yields and throws it back.
  const bool landed = lowest < 0 && lowest > btScalar(-0.3) && fastest < 4;

  solver.removeRigidBody(&crate);
  world.removeRigidBody(&crate);
  solver.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
  return landed ? 0 : 1;
}
