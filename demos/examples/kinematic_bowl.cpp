// A bowl that the game moves: a kinematic collision object, whose transform is read at every step, carries
// water. There is no soft body, so that a btDiscreteDynamicsWorld and a btFluidCoupling are enough.
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "oilskin/bullet.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// Half a sphere about the origin, open at the top.
static void addHemisphere(btTriangleMesh& mesh, btScalar radius) {
  const int rings = 8, sectors = 24;
  const auto at = [&](int ring, int sector) {
    const btScalar down = SIMD_HALF_PI * btScalar(ring) / rings,
                   around = SIMD_2_PI * btScalar(sector) / sectors;
    return radius * btVector3(btCos(down) * btCos(around), -btSin(down), btCos(down) * btSin(around));
  };
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      mesh.addTriangle(at(i, k), at(i + 1, k), at(i, k + 1));
      mesh.addTriangle(at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
    }
}

int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);

  const btScalar radius = btScalar(0.1);  // [m]
  btTriangleMesh mesh;
  addHemisphere(mesh, radius);
  btBvhTriangleMeshShape shape(&mesh, true);
  btRigidBody bowl(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape));
  bowl.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  bowl.setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(&bowl);

  oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
  oilskin::bullet::btFluidCoupling coupling(&water);
  const btScalar a = btScalar(0.04);
  if (!accepted(coupling.addCollisionObject(&bowl, btScalar(0.002))) ||  // thickness [m]
      !accepted(water.addBox({-a, btScalar(-0.08), -a}, {a, btScalar(-0.04), a})))
    return 1;

  // 0.3 m to the side and 0.2 m up in one second, gently at both ends.
  const int steps = 500;
  const btScalar dt = btScalar(1.) / steps;  // [s]
  for (int i = 1; i <= steps; ++i) {
    const btScalar s = (1 - btCos(SIMD_PI * btScalar(i) / steps)) / 2;
    bowl.setWorldTransform(
        btTransform(btQuaternion::getIdentity(), s * btVector3(btScalar(0.3), btScalar(0.2), 0)));
    world.stepSimulation(dt, 0);  // exactly one sub-step
    if (!accepted(coupling.step(dt).status)) return 1;
  }

  int carried = 0;
  const btVector3 centre = bowl.getWorldTransform().getOrigin();
  for (int i = 0; i < water.getNumParticles(); ++i) carried += water.getPosition(i).distance(centre) < radius;
  const int particles = water.getNumParticles();
  std::printf("the bowl moved by %.2f m and carries %d of %d particles\n", double(centre.length()), carried,
              particles);

  coupling.removeCollisionObject(&bowl);
  world.removeRigidBody(&bowl);
  return particles > 100 && carried == particles ? 0 : 1;
}
