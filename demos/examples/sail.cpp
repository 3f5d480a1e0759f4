// A raft with a sail of cloth: the wind fills the sail, and the sail pulls the raft across a tank.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cstdio>

#include "oilskin/bullet.h"
#include "oilskin/bullet_force.h"

namespace {

const btVector3 wind(4, 0, 0);        // [m/s]
const btScalar dt = btScalar(0.002);  // [s]

bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

btRigidBody make_body(btCollisionShape& shape, btScalar mass, const btVector3& at) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0) shape.calculateLocalInertia(mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
  info.m_startWorldTransform.setOrigin(at);
  return btRigidBody(info);
}

// 9 × 9 nodes, 12 × 12 cm, 8 g, in the plane x = 0 of the raft; its upper and lower edges are anchored.
btSoftBody* make_sail(btSoftBodyWorldInfo& world_info, btRigidBody& raft) {
  const btVector3 at = raft.getWorldTransform().getOrigin();
  const btScalar r = btScalar(0.06), low = at.y() + btScalar(0.04), high = at.y() + btScalar(0.16);
  const int n = 9;
  btSoftBody* sail = btSoftBodyHelpers::CreatePatch(world_info, {at.x(), low, -r}, {at.x(), low, r},
                                                    {at.x(), high, -r}, {at.x(), high, r}, n, n, 0, true);
  sail->setTotalMass(btScalar(0.008));
  sail->m_cfg.piterations = 8;
  sail->getCollisionShape()->setMargin(btScalar(0.005));  // Bullet's default is 25 cm
  for (int i = 0; i < n; ++i) {
    sail->appendAnchor(i, &raft, true);
    sail->appendAnchor(n * (n - 1) + i, &raft, true);
  }
  return sail;
}

// Drag of the air on each face: Bullet's own wind leaves cloth at rest. It must not outrun the wind in a
// step.
void blow(btSoftBody& sail) {
  const btScalar air = btScalar(1.2);  // [kg/m³]
  for (int f = 0; f < sail.m_faces.size(); ++f) {
    btSoftBody::Node* const* n = sail.m_faces[f].m_n;
    const btVector3 u = wind - (n[0]->m_v + n[1]->m_v + n[2]->m_v) / 3;
    const btVector3 normal = (n[1]->m_x - n[0]->m_x).cross(n[2]->m_x - n[0]->m_x);  // twice the area
    if (normal.fuzzyZero()) continue;
    const btScalar rate = air * u.length() * normal.length() / 12;  // of a node [kg/s]
    const btVector3 across = normal.normalized();
    for (int k = 0; k < 3; ++k)
      sail.addForce(rate / (1 + rate * dt * n[k]->m_im) * u.dot(across) * across,
                    static_cast<int>(n[k] - &sail.m_nodes[0]));
  }
}

}  // namespace

int main() {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world.setGravity(btVector3(0, btScalar(-9.81), 0));
  world.getWorldInfo().m_gravity = world.getGravity();

  // A tank of 60 × 20 cm, whose floor is at y = 0, with 7 cm of water.
  const btScalar t = btScalar(0.02), h = btScalar(0.1), wide = btScalar(0.3), deep = btScalar(0.1);
  btBoxShape floorShape(btVector3(wide + 2 * t, t, deep + 2 * t)), endShape(btVector3(t, h, deep + 2 * t)),
      sideShape(btVector3(wide, h, t));
  btRigidBody tank[] = {make_body(floorShape, 0, {0, -t, 0}), make_body(endShape, 0, {-wide - t, h, 0}),
                        make_body(endShape, 0, {wide + t, h, 0}), make_body(sideShape, 0, {0, h, -deep - t}),
                        make_body(sideShape, 0, {0, h, deep + t})};
  // Mast and boom have no mass here: the sail is anchored to the hull.
  btBoxShape hull(btVector3(btScalar(0.08), btScalar(0.015), btScalar(0.06)));
  btRigidBody raft = make_body(hull, btScalar(0.2), {btScalar(-0.19), btScalar(0.085), 0});
  raft.setActivationState(DISABLE_DEACTIVATION);
  btSoftBody* sail = make_sail(world.getWorldInfo(), raft);
  const btScalar thickness = btScalar(0.002);  // [m]
  oilskin::bullet::btFluid water(btScalar(0.012));
  oilskin::bullet::btFluidWind breeze(wind);
  if (!accepted(solver.addFluid(&water)) || !accepted(water.addForce(&breeze))) return 1;
  for (btRigidBody& wall : tank) {
    wall.getCollisionShape()->setMargin(btScalar(0.001));
    world.addRigidBody(&wall);
    if (!accepted(solver.addCollisionObject(&wall, thickness))) return 1;
  }
  hull.setMargin(btScalar(0.001));
  world.addRigidBody(&raft);
  world.addSoftBody(sail);
  if (!accepted(solver.addRigidBody(&raft, thickness)) || !accepted(solver.addCloth(sail, thickness)) ||
      !accepted(water.addBox({-wide, 0, -deep}, {wide, btScalar(0.07), deep})))
    return 1;

  const btVector3 start = raft.getWorldTransform().getOrigin();
  for (int i = 0; i < 500; ++i) {
    blow(*sail);
    world.stepSimulation(dt, 0);
    if (!accepted(solver.getReport().status)) return 1;
  }
  const btVector3 end = raft.getWorldTransform().getOrigin();
  std::printf("the raft went %.1f cm in 1 s and floats at %.1f cm\n", 100 * double(end.x() - start.x()),
              100 * double(end.y()));

  solver.removeCloth(sail);
  world.removeSoftBody(sail);
  delete sail;
  world.removeRigidBody(&raft);
  for (btRigidBody& wall : tank) world.removeRigidBody(&wall);
  const bool upright = raft.getWorldTransform().getBasis()[1][1] > btScalar(0.8);
  return end.x() - start.x() > btScalar(0.05) && end.y() > btScalar(0.05) && upright ? 0 : 1;
}
