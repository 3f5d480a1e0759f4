// Two fluids in one coupling: rain on an awning from above, and oil that a burst pipe throws at it from
// below. Both move the cloth in the same step, and neither passes it.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>

#include "oilskin/bullet.h"

namespace {

bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

// A square of 17 × 17 nodes and 60 g, whose four edges are pinned.
btSoftBody* make_awning(btSoftBodyWorldInfo& world_info) {
  const btScalar r = btScalar(0.2);
  const int n = 17;
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world_info, {-r, 0, -r}, {r, 0, -r}, {-r, 0, r},
                                                     {r, 0, r}, n, n, 0, true);
  cloth->setTotalMass(btScalar(0.06));
  cloth->m_cfg.piterations = 10;
  for (int i = 0; i < n * n; ++i)
    if (i % n == 0 || i % n == n - 1 || i < n || i >= n * (n - 1)) cloth->setMass(i, 0);
  return cloth;
}

oilskin::FluidSettings liquid(double spacing, double density, double viscosity) {
  oilskin::FluidSettings settings;
  settings.spacing = spacing;       // [m]
  settings.rest_density = density;  // [kg/m³]
  settings.viscosity = viscosity;   // [m²/s]
  return settings;
}

// Particles within the awning's square that are on the wrong side of its plane by more than it sags.
int count_strays(const oilskin::bullet::btFluid& fluid, btScalar side) {
  int strays = 0;
  for (int i = 0; i < fluid.getNumParticles(); ++i) {
    const btVector3 x = fluid.getPosition(i);
    const bool inside = btFabs(x.x()) < btScalar(0.15) && btFabs(x.z()) < btScalar(0.15);
    if (inside && side * x.y() < btScalar(-0.06)) ++strays;
  }
  return strays;
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
  btSoftBody* awning = make_awning(world.getWorldInfo());
  world.addSoftBody(awning);

  oilskin::WorldSettings box;
  box.kill_box = {oilskin::Vec3(-1, -0.5, -1), oilskin::Vec3(1, 1, 1)};
  oilskin::bullet::btFluid water(liquid(0.012, 1000, 1e-6), box, {});
  oilskin::bullet::btFluid oil(liquid(0.01, 900, 1e-4), box, {});
  if (!accepted(solver.addFluid(&water)) || !accepted(solver.addFluid(&oil)) ||
      !accepted(solver.addCloth(awning, btScalar(0.002))) ||
      !accepted(water.addJet({0, btScalar(0.15), 0}, {0, -1, 0}, 1, btScalar(0.04))) ||
      !accepted(oil.addJet({0, btScalar(-0.2), 0}, {0, 1, 0}, btScalar(2.5), btScalar(0.02))))
    return 1;

  std::uint64_t of_water = 0, of_oil = 0;
  for (int frame = 0; frame < 30; ++frame) {
    world.stepSimulation(btScalar(1. / 60), 40, btScalar(0.001));
    if (!accepted(solver.getReport().status)) return 1;  // of both fluids together
    of_water += water.getWorld().contacts().size();      // of each one
    of_oil += oil.getWorld().contacts().size();
  }
  const int strays = count_strays(water, 1) + count_strays(oil, -1);
  std::printf("%d particles of water and %d of oil; %d on the wrong side\n", water.getNumParticles(),
              oil.getNumParticles(), strays);

  solver.removeCloth(awning);
  world.removeSoftBody(awning);
  delete awning;
  return of_water > 0 && of_oil > 0 && strays == 0 ? 0 : 1;
}
