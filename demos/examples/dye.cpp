// An effect of one's own: dyed cloth that a jet rinses. Particles that touch the cloth take a part of its dye
// with them.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cmath>
#include <cstdio>

#include "oilskin/bullet.h"

namespace {

/// The world keeps one number for each particle and one for each node, the amount of dye [g].
class Dye : public oilskin::Effect {
 public:
  std::string name() const override { return "dye"; }
  std::vector<double> particle_values() const override { return {0}; }  // water is clear when it starts
  std::vector<double> node_values() const override { return {0}; }

  /// After contact: what a node loses, a particle gets.
  void exchange(oilskin::EffectExchange& e) override {
    const double share = -std::expm1(-washes_out_ * e.dt);
    for (const oilskin::Contact& contact : e.contacts)
      for (int k = 0; k < 3; ++k) {
        double& of_node = e.of_nodes(contact.surface, 0)[contact.nodes[k]];
        const double moved = share * contact.weights[k] * of_node;
        of_node -= moved;
        e.of_particles(0)[contact.particle] += moved;
      }
  }

 private:
  static constexpr double washes_out_ = 5;  // [1/s], at a particle in contact
};

double sum(oilskin::Span<const double> values) {
  double total = 0;
  for (double v : values) total += v;
  return total;
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
  const btScalar r = btScalar(0.15);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r},
                                                     {-r, 0, r}, {r, 0, r}, 21, 21, 15, true);
  cloth->setTotalMass(btScalar(0.03));
  cloth->getCollisionShape()->setMargin(btScalar(0.005));
  world.addSoftBody(cloth);

  oilskin::bullet::btFluid water(btScalar(0.01));
  if (!accepted(solver.addFluid(&water)) || !accepted(solver.addCloth(cloth, btScalar(0.001)))) return 1;
  if (!accepted(water.addJet({0, btScalar(0.1), 0}, {0, -1, 0}, btScalar(1.5), btScalar(0.03)))) return 1;

  Dye dye;
  oilskin::World& fluid = water.getWorld();
  const oilskin::SurfaceId dyed = solver.getCoupling().getSurfaceId(cloth);
  const std::vector<double> full(std::size_t(cloth->m_nodes.size()), 0.01);
  if (!accepted(fluid.add_effect(dye)) || !accepted(fluid.set_node_values(dye, dyed, 0, full))) return 1;

  for (int frame = 0; frame < 20; ++frame) world.stepSimulation(btScalar(1. / 60), 20, btScalar(0.001));
  const double left = sum(fluid.node_values(dye, dyed, 0)), taken = sum(fluid.particle_values(dye, 0));
  std::printf("%.3f g of %.3f g are in the cloth, %.3f g in the water\n", left, sum(full), taken);

  solver.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
  return left < 0.95 * sum(full) && std::abs(left + taken - sum(full)) < 1e-9 ? 0 : 1;
}
