// A basin whose plug is pulled: the water runs through a hole in the floor and ends in a sink below. A
// draught of air ruffles the water meanwhile. Sink and wind are the game's own objects.
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "oilskin/bullet_force.h"
#include "oilskin/bullet_sink.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// A floor with a square hole in the middle, and walls around it. Seen from above.
static void addBasin(btTriangleMesh& mesh, btScalar half, btScalar hole, btScalar height) {
  btVector3 inner[4], outer[4], top[4];
  for (int k = 0; k < 4; ++k) {
    const btVector3 corner(btScalar(k == 1 || k == 2 ? 1 : -1), 0, btScalar(k >= 2 ? 1 : -1));
    inner[k] = corner * hole;
    outer[k] = corner * half;
    top[k] = outer[k] + btVector3(0, height, 0);
  }
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    mesh.addTriangle(outer[k], inner[k], inner[next]);
    mesh.addTriangle(outer[k], inner[next], outer[next]);
    mesh.addTriangle(top[k], outer[k], outer[next]);
    mesh.addTriangle(top[k], outer[next], top[next]);
  }
}

int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);

  const btScalar half = btScalar(0.1), hole = btScalar(0.03), height = btScalar(0.15);  // [m]
  btTriangleMesh mesh;
  addBasin(mesh, half, hole, height);
  btBvhTriangleMeshShape shape(&mesh, true);
  btRigidBody basin(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape));
  const btScalar thickness = btScalar(0.005);
  btBoxShape plugShape({2 * hole, thickness, 2 * hole});
  btRigidBody plug(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &plugShape));
  plug.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, btScalar(-0.01), 0}));
  world.addRigidBody(&basin);
  world.addRigidBody(&plug);

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  oilskin::bullet::btFluidCoupling coupling(&water);
  btBoxShape below({1, btScalar(0.1), 1});
  oilskin::bullet::btFluidSink sink(&below);
  oilskin::bullet::btFluidWind wind({4, 0, 0});  // [m/s]
  if (!accepted(sink.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, btScalar(-0.3), 0}))) ||
      !accepted(coupling.addCollisionObject(&basin, btScalar(0.002))) ||
      !accepted(coupling.addCollisionObject(&plug, btScalar(0.002))) || !accepted(water.addSink(&sink)) ||
      !accepted(water.addForce(&wind)) ||
      !accepted(water.addBox({-half, 0, -half}, {half, btScalar(0.08), half})))
    return 1;

  const btScalar frame = btScalar(1.) / 60;  // [s]
  const int resting = 20, draining = 180;
  int full = 0;
  for (int i = 0; i < resting + draining; ++i) {
    if (i == resting) {
      full = water.getNumParticles();
      coupling.removeCollisionObject(&plug);
      world.removeRigidBody(&plug);
    }
    world.stepSimulation(frame, 0);
    if (!accepted(coupling.step(frame).status)) return 1;
  }

  const oilskin::StepReport all = coupling.takeReport();
  const unsigned long long taken = sink.getTakenParticles();
  const int left = water.getNumParticles();
  std::printf("of %d particles the sink took %llu, %.2f litres; %d are left\n", full, taken,
              1000 * double(sink.getTakenVolume()), left);
  coupling.removeCollisionObject(&basin);
  world.removeRigidBody(&basin);
  const bool exact = all.emitted == all.removed + (unsigned)left && all.removed == taken;
  return exact && left * 10 < full ? 0 : 1;
}
