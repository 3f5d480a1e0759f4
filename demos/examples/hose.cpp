// A hose that the game steers in every frame: it fills a tank, is closed, and the tank is drained. The
// emitter is the game's own object, as a rigid body is.
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "oilskin/bullet_emitter.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// A box that is open at the top, with a square base.
static void addTank(btTriangleMesh& mesh, btScalar half, btScalar height) {
  btVector3 low[4], high[4];
  for (int k = 0; k < 4; ++k) {
    low[k] = btVector3(k == 1 || k == 2 ? half : -half, 0, k >= 2 ? half : -half);
    high[k] = low[k] + btVector3(0, height, 0);
  }
  const auto add = [&](const btVector3& a, const btVector3& b, const btVector3& c, const btVector3& d) {
    mesh.addTriangle(a, b, c);
    mesh.addTriangle(a, c, d);
  };
  add(low[0], low[3], low[2], low[1]);
  for (int k = 0; k < 4; ++k) add(low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]);
}

int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);

  const btScalar half = btScalar(0.12), height = btScalar(0.2);  // [m]
  btTriangleMesh mesh;
  addTank(mesh, half, height);
  btBvhTriangleMeshShape shape(&mesh, true);
  btRigidBody tank(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape));
  world.addRigidBody(&tank);

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  oilskin::bullet::btFluidCoupling coupling(&water);
  const btScalar radius = btScalar(0.03), speed = 1;  // [m], [m/s]
  oilskin::bullet::btFluidDiscEmitter hose(radius, speed);
  if (!accepted(hose.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, btScalar(0.25), 0}))) ||
      !accepted(coupling.addCollisionObject(&tank, btScalar(0.002))) || !accepted(water.addEmitter(&hose)))
    return 1;

  const btScalar frame = btScalar(1.) / 60;  // [s]
  const int subSteps = 2, filling = 42, draining = 90;
  unsigned long long drained = 0, gone = 0;  // gone: by all reports
  for (int i = 0; i < filling + draining; ++i) {
    // The water leaves along −y of the hose, which swings from side to side.
    const btScalar swing = btSin(btScalar(0.15) * btScalar(i));
    const btVector3 place(btScalar(0.04) * swing, btScalar(0.25), 0);
    const btQuaternion turn(btVector3(0, 0, 1), btScalar(0.3) * swing);
    if (!accepted(hose.setWorldTransform(btTransform(turn, place), frame))) return 1;
    if (i == filling && !accepted(hose.setEnabled(false))) return 1;
    for (int k = 0; k < subSteps; ++k) {
      world.stepSimulation(frame / subSteps, 0);
      const oilskin::StepReport& report = coupling.step(frame / subSteps);
      if (!accepted(report.status)) return 1;
      gone += report.removed;
    }
    const btScalar low = btScalar(0.06);  // what has come down to the bottom leaves
    if (i >= filling) drained += (unsigned)water.removeParticles({-half, 0, -half}, {half, low, half});
  }

  const double asked = double(SIMD_PI * radius * radius * speed) * filling * double(frame);  // [m³]
  const double emitted = double(hose.getEmittedVolume());
  gone += coupling.step(frame).removed;  // a report has what was removed since the last step
  const unsigned long long left = (unsigned)water.getNumParticles();
  const unsigned long long came = water.getWorld().emitter(hose.getEmitterId())->particles;
  std::printf("the hose gave %.3f litres of %.3f asked; of %llu particles %llu were drained, %llu are left\n",
              1000 * emitted, 1000 * asked, came, drained, left);

  coupling.removeCollisionObject(&tank);
  world.removeRigidBody(&tank);
  const bool flows = btFabs(btScalar(emitted / asked - 1)) < btScalar(0.0125);  // to a layer
  const bool drains = left < 50 && drained * 100 > came * 99;                   // the rest went over the rim
  return flows && drains && came == gone + left ? 0 : 1;
}
