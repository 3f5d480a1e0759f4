// Crates that a Bullet world owns: one floats, one sinks, and a jet pushes the floating one across the tank.
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>

#include "oilskin/bullet.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// A box with its owner's mass [kg]; 0 = static.
static btRigidBody make_box(btBoxShape& shape, btScalar mass, const btVector3& at) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0) shape.calculateLocalInertia(mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
  info.m_startWorldTransform.setOrigin(at);
  return btRigidBody(info);
}

int main() {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world.setGravity(btVector3(0, btScalar(-9.81), 0));

  // A tank of 24 × 14 cm, whose floor is at y = 0.
  const btScalar t = btScalar(0.02), h = btScalar(0.15), wide = btScalar(0.12), deep = btScalar(0.07);
  btBoxShape floorShape(btVector3(wide + 2 * t, t, deep + 2 * t)), sideShape(btVector3(t, h, deep + 2 * t)),
      endShape(btVector3(wide, h, t));
  btRigidBody tank[] = {make_box(floorShape, 0, {0, -t, 0}), make_box(sideShape, 0, {-wide - t, h, 0}),
                        make_box(sideShape, 0, {wide + t, h, 0}), make_box(endShape, 0, {0, h, -deep - t}),
                        make_box(endShape, 0, {0, h, deep + t})};
  btBoxShape crateShape(btVector3(btScalar(0.035), btScalar(0.03), btScalar(0.035)));
  btRigidBody light = make_box(crateShape, btScalar(0.2), {btScalar(-0.06), btScalar(0.14), 0}),
              heavy = make_box(crateShape, btScalar(0.7), {btScalar(0.06), btScalar(0.14), 0});
  const btScalar thickness = btScalar(0.002);  // [m]

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  if (!accepted(solver.addFluid(&water))) return 1;
  for (btRigidBody& wall : tank) {
    wall.getCollisionShape()->setMargin(btScalar(0.001));
    world.addRigidBody(&wall);
    if (!accepted(solver.addCollisionObject(&wall, thickness))) return 1;
  }
  for (btRigidBody* crate : {&light, &heavy}) {
    crate->getCollisionShape()->setMargin(btScalar(0.001));
    world.addRigidBody(crate);
    if (!accepted(solver.addRigidBody(crate, thickness))) return 1;  // the water moves it, and it the water
  }
  if (!accepted(water.addBox({-wide, 0, -deep}, {wide, btScalar(0.08), deep}))) return 1;

  const btScalar dt = btScalar(0.004);                        // [s]
  for (int i = 0; i < 200; ++i) world.stepSimulation(dt, 0);  // they drop in and come to rest
  const btScalar floating = light.getWorldTransform().getOrigin().y();
  const btScalar sunk = heavy.getWorldTransform().getOrigin().y();
  std::printf("the crate of 0.2 kg floats at %.1f cm, that of 0.7 kg lies at %.1f cm\n",
              100 * double(floating), 100 * double(sunk));

  const btScalar before = light.getWorldTransform().getOrigin().x();
  if (!accepted(water.addJet({btScalar(-0.115), floating + btScalar(0.02), 0}, {1, 0, 0}, btScalar(2),
                             btScalar(0.012))))
    return 1;
  for (int i = 0; i < 60; ++i) world.stepSimulation(dt, 0);
  const btScalar pushed = light.getWorldTransform().getOrigin().x() - before;
  std::printf("the jet pushes it by %.1f cm\n", 100 * double(pushed));

  const bool right = floating > btScalar(0.075) && sunk < btScalar(0.045) && pushed > btScalar(0.01);
  for (btRigidBody* crate : {&light, &heavy}) world.removeRigidBody(crate);
  for (btRigidBody& wall : tank) world.removeRigidBody(&wall);
  return right ? 0 : 1;
}
