/// A small Bullet world for the tests of the adapter. Compiled in both precisions.
#pragma once

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <memory>

#include "bullet_adapter/convert.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"

namespace oilskin::bullet::test {

constexpr bool is_double = bt_storage == Storage::float64;

inline btScalar bt(double x) {
  return static_cast<btScalar>(x);
}

inline WorldSettings small_world() {
  WorldSettings world;
  world.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  world.threads = 1;
  return world;
}

inline FluidSettings coarse_fluid(PressureSolver solver = PressureSolver::pcisph) {
  FluidSettings fluid;
  fluid.spacing = 0.02;
  fluid.solver = solver;
  fluid.boundary = BoundaryModel::contact_only;
  fluid.max_substeps = 1;
  return fluid;
}

inline ContactSettings verified() {
  ContactSettings contact;
  contact.verify = true;
  return contact;
}

/// Owns a world of one of Bullet's soft-body kinds; soft bodies added with own() go with it.
template <class DynamicsWorld, class ConstraintSolver>
class BasicSoftWorld {
 public:
  explicit BasicSoftWorld(const btVector3& gravity = btVector3(0, 0, 0),
                          btSoftBodySolver* soft_solver = nullptr)
      : dispatcher_(&configuration_),
        world(&dispatcher_, &broadphase_, &constraints_, &configuration_, soft_solver) {
    world.setGravity(gravity);
    world.getWorldInfo().m_gravity = gravity;
  }
  ~BasicSoftWorld() {
    for (auto& body : bodies_) world.removeSoftBody(body.get());
  }

  btSoftBody* own(btSoftBody* body) {
    bodies_.emplace_back(body);
    world.addSoftBody(body);
    return body;
  }

  /// n × n nodes over size × size metres at height y; the corners of the bit mask `fixed` are pinned.
  btSoftBody* patch(int n, double size, double y = 0, int fixed = 0, double mass = 0.05) {
    const double r = size / 2;
    btSoftBody* cloth =
        btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {bt(-r), bt(y), bt(-r)}, {bt(r), bt(y), bt(-r)},
                                       {bt(-r), bt(y), bt(r)}, {bt(r), bt(y), bt(r)}, n, n, fixed, true);
    cloth->setTotalMass(bt(mass));
    cloth->m_cfg.kDP = 0;
    cloth->m_cfg.piterations = 4;
    cloth->getCollisionShape()->setMargin(bt(0.005));
    return own(cloth);
  }

  /// Takes a body out of the world and deletes it.
  void destroy(btSoftBody* body) {
    world.removeSoftBody(body);
    bodies_.erase(std::find_if(bodies_.begin(), bodies_.end(),
                               [body](const auto& owned) { return owned.get() == body; }));
  }

  /// Exactly one sub-step.
  void step(double dt) { world.stepSimulation(bt(dt), 0); }

 private:
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  ConstraintSolver constraints_;

 public:
  DynamicsWorld world;

 private:
  std::vector<std::unique_ptr<btSoftBody>> bodies_;
};

using SoftWorld = BasicSoftWorld<btSoftRigidDynamicsWorld, btSequentialImpulseConstraintSolver>;

inline Vec3 momentum(const btSoftBody& body) {
  Vec3 p = Vec3::Zero();
  for (int i = 0; i < body.m_nodes.size(); ++i)
    if (body.m_nodes[i].m_im > 0)
      p += to_vec3(body.m_nodes[i].m_v) / static_cast<double>(body.m_nodes[i].m_im);
  return p;
}

/// What the world does around a step: x_t0 is what the last scatter left.
inline Gathered gather_step(SurfaceHost& host, double dt, SurfaceMotion& motion) {
  motion.x_t0 = motion.x_t1;
  Gathered gathered = host.gather(dt, motion);
  if (gathered.new_surface) motion.x_t0 = motion.x_t1;
  motion.impulse.assign(motion.x_t1.size(), Vec3::Zero());
  motion.moved.assign(motion.x_t1.size(), 0);
  return gathered;
}

}  // namespace oilskin::bullet::test
