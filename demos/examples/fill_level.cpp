// Questions to the water between steps: how much is in a box, where its surface is, and whether a camera is
// under water. A block of water collapses in a tank.
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>

#include "oilskin/bullet.h"
#include "oilskin/water_query.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

/// Floor and walls of a tank, open at the top: x and z from -half to half, y from 0 to height.
static void addTank(btTriangleMesh& mesh, btScalar half, btScalar height) {
  const btVector3 corner[4] = {{-half, 0, -half}, {half, 0, -half}, {half, 0, half}, {-half, 0, half}};
  const btVector3 up(0, height, 0);
  mesh.addTriangle(corner[0], corner[2], corner[1]);
  mesh.addTriangle(corner[0], corner[3], corner[2]);
  for (int i = 0; i < 4; ++i) {
    const btVector3 &a = corner[i], &b = corner[(i + 1) % 4];
    mesh.addTriangle(a, b, b + up);
    mesh.addTriangle(a, b + up, a + up);
  }
}

int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);

  const btScalar half = btScalar(0.1), spacing = btScalar(0.01);  // [m]
  btTriangleMesh mesh;
  addTank(mesh, half, btScalar(0.3));
  btBvhTriangleMeshShape shape(&mesh, true);
  btRigidBody tank(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape));
  world.addRigidBody(&tank);

  oilskin::bullet::btFluid water(spacing);
  oilskin::bullet::btFluidCoupling coupling(&water);
  const btScalar gap = btScalar(0.005);
  if (!accepted(coupling.addCollisionObject(&tank, btScalar(0.002))) ||
      !accepted(water.addBox({-half + gap, gap, -half + gap}, {0, btScalar(0.1), half - gap})))
    return 1;

  const oilskin::Box right = {oilskin::Vec3(0, 0, -0.1), oilskin::Vec3(0.1, 0.3, 0.1)};
  const oilskin::Vec3 camera(0.05, 0.02, 0), above(0.05, 0.3, 0), below(0.05, 0, 0);
  const oilskin::Box tank_space = {oilskin::Vec3(-0.1, 0, -0.1), oilskin::Vec3(0.1, 0.3, 0.1)};
  double litres = 0, held = 0, level = 0;
  bool wet = false;
  for (int i = 0; i <= 500; ++i) {
    if (i % 100 == 0) {
      const oilskin::WaterQuery query(water.getWorld());  // a copy: make a new one after each step
      oilskin::WaterSample at_camera;
      oilskin::WaterHit surface;
      if (!accepted(query.volume(right, &litres)) || !accepted(query.volume(tank_space, &held)) ||
          !accepted(query.sample(camera, &at_camera)) || !accepted(query.ray(above, below, &surface)))
        return 1;
      litres *= 1000, held *= 1000;
      level = surface.found ? surface.place.y() : 0;
      // Beside a free surface the density is lower: half of the rest density is the surface.
      wet = at_camera.density > 0.5 * water.getWorld().fluid_settings().rest_density;
      std::printf("%.1f s: %.2f litres in the right half, its surface at %.3f m, the camera is %s water\n",
                  water.getWorld().time(), litres, level, wet ? "under" : "above");
    }
    world.stepSimulation(btScalar(0.002), 0);
    if (!accepted(coupling.step(btScalar(0.002)).status)) return 1;
  }

  const double all = 1000 * water.getNumParticles() * water.getWorld().particle_mass() /
                     water.getWorld().fluid_settings().rest_density;
  const double expected = 1e-3 * all / (4 * half * half);
  std::printf("the tank holds %.2f of %.2f litres; at rest the level is %.3f m\n", held, all, expected);
  coupling.removeCollisionObject(&tank);
  world.removeRigidBody(&tank);
  return wet && litres > 0.25 * all && std::abs(held - all) < 1e-6 * all &&
                 std::abs(level - expected) < 2 * spacing
             ? 0
             : 1;
}
