// The calls of RandomGame. Objects of Bullet's are changed in ways that Bullet takes; odd numbers go to the
// adapter alone.
#include "random_game.h"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <gtest/gtest.h>

#include <cmath>

#include "game.h"
#include "oilskin/bullet_query.h"

namespace oilskin::bullet::test {

namespace {

btVector3 inertia_of(const btCollisionShape& shape, btScalar mass) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0) shape.calculateLocalInertia(mass, inertia);
  return inertia;
}

}  // namespace

// --- water

void RandomGame::change_fluid() {
  switch (random_.below(5)) {
    case 0:
    case 1: {
      if (fluids_.size() >= 3) return;
      FluidSettings settings = coarse_fluid(static_cast<PressureSolver>(random_.below(3)));
      settings.max_substeps = 1 + static_cast<int>(random_.below(3));
      if (settings.solver != PressureSolver::mcg03 && once_in(2)) settings.boundary = BoundaryModel::mirrored;
      fluids_.push_back(std::make_unique<btFluid>(settings, with_threads(threads_), verified()));
      break;
    }
    case 2:
    case 3:
      if (!fluids_.empty()) note(solver_->addFluid(&any(fluids_)));
      break;
    case 4:
      if (!once_in(4)) return;
      if (fluid() && once_in(2)) return solver_->removeFluid(fluid());
      erase_any(fluids_);
  }
}

void RandomGame::pour() {
  btFluid* water = fluid();
  if (!water) return change_fluid();
  if (once_in(2)) {
    const btVector3 middle = place(0.15),
                    half = 0.5 * (place(0.1).absolute() + btVector3(bt(0.05), bt(0.05), bt(0.05)));
    return note(water->addBox(middle - half, middle + half, place(1)));
  }
  note(water->addJet(place(0.2), place(1), number(0.2, 3), number(0.02, 0.05)));
}

void RandomGame::limit_particles() {
  btFluid* water = fluid();
  if (!water) return;
  switch (random_.below(4)) {
    case 0:
      return water->setMaxParticles(static_cast<int>(random_.below(3000)));
    case 1:
      return once_in(3) ? water->clear() : void();
    case 2:
      water->removeParticles(place(0.2), place(0.2));
      water->removeParticles(new_convex_shape(), pose());
      break;
    case 3:
      note(water->setMaxAge(number(0.05, 1)));
  }
}

void RandomGame::use_emitter() {
  if (emitters_.empty() || (emitters_.size() < 6 && once_in(3))) {
    const btVector3 half(bt(0.05), bt(0.03), bt(0.05));
    switch (random_.below(4)) {
      case 0:
        emitters_.push_back(std::make_unique<btFluidDiscEmitter>(number(0.01, 0.04), number(0, 2)));
        break;
      case 1:
        emitters_.push_back(std::make_unique<btFluidBoxEmitter>(half));
        break;
      case 2:
        emitters_.push_back(std::make_unique<btFluidRainEmitter>(bt(0.2), bt(0.2), bt(500), number(0, 0.02)));
        break;
      case 3:
        emitters_.push_back(std::make_unique<btFluidMeshEmitter>(new_convex_shape()));
    }
  }
  btFluidEmitter& emitter = any(emitters_);
  switch (random_.below(8)) {
    case 0:
    case 1:
      return fluid() ? note(fluid()->addEmitter(&emitter)) : void();
    case 2:
      return note(emitter.setWorldTransform(pose(), number(0, 0.02)));
    case 3:
      return note(emitter.teleport(pose()));
    case 4:
      return note(emitter.setSpeed(std::min(number(0, 2), bt(10))));
    case 5:
      return note(emitter.setEnabled(once_in(2)));
    case 6:
      return note(emitter.setInheritedVelocity(place(1)));
    case 7:
      if (once_in(3)) erase_any(emitters_);
  }
}

void RandomGame::use_sink() {
  if (sinks_.size() < 3)
    sinks_.push_back(std::make_unique<btFluidSink>(once_in(8) ? nullptr : new_convex_shape()));
  btFluidSink& sink = any(sinks_);
  if (fluid() && once_in(2)) note(fluid()->addSink(&sink));
  note(once_in(2) ? sink.setWorldTransform(pose()) : sink.setEnabled(once_in(2)));
  if (once_in(6)) erase_any(sinks_);
}

void RandomGame::use_force() {
  if (forces_.size() < 3) {
    if (once_in(2))
      forces_.push_back(std::make_unique<btFluidUniformForce>(place(10)));
    else
      forces_.push_back(std::make_unique<btFluidWind>(place(5)));
  }
  btFluidForce& force = any(forces_);
  if (fluid() && once_in(2)) note(fluid()->addForce(&force));
  note(once_in(2) ? force.setRegion(new_convex_shape(), pose()) : force.setEnabled(once_in(2)));
  if (once_in(6)) erase_any(forces_);
}

void RandomGame::use_listener() {
  if (listeners_.size() < 3) listeners_.push_back(std::make_unique<Listener>(*this));
  Listener& listener = any(listeners_);
  note(listener.setSplashThreshold(number(0, 1e-4)));
  if (!once_in(3)) return note(solver_->addListener(&listener));
  if (once_in(2)) return solver_->removeListener(&listener);
  erase_any(listeners_);
}

void RandomGame::ask() {
  if (!fluid()) return;
  const btFluidQuery query(*fluid());
  btScalar level = 0;
  btFluidRayResult hit;
  if (query.getLevel(place(0.3), place(1), level)) seen_.is_finite &= std::isfinite(level);
  if (query.rayTest(place(0.3), place(0.3), hit))
    seen_.is_finite &= hit.m_fraction >= 0 && hit.m_fraction <= 1;
  seen_.is_finite &= std::isfinite(query.getVolume(new_convex_shape(), pose()));
  seen_.is_finite &= std::isfinite(query.getDensity(place(0.2)));
  if (!cloths_.empty()) query.isNodeWet(cloths_[0], static_cast<int>(random_.below(200)) - 20);
}

// --- objects that stand still, and sensors

btConvexShape* RandomGame::new_convex_shape() {
  btConvexShape* shape = nullptr;
  switch (random_.below(4)) {
    case 0:
      shape = new btSphereShape(bt(random_.uniform(0.02, 0.1)));
      break;
    case 1:
      shape = new btCapsuleShape(bt(random_.uniform(0.02, 0.05)), bt(0.05));
      break;
    case 2:
      shape = new btCylinderShape(btVector3(bt(0.05), bt(0.03), bt(0.05)));
      break;
    default:
      shape = new btBoxShape(place(0.08).absolute() + btVector3(bt(0.02), bt(0.02), bt(0.02)));
  }
  shapes_.emplace_back(shape);
  return shape;
}

btCollisionShape* RandomGame::new_shape() {
  if (!once_in(4)) return new_convex_shape();
  auto* compound = new btCompoundShape;
  shapes_.emplace_back(compound);
  for (int k = 0; k < 2; ++k) compound->addChildShape(pose(), new_convex_shape());
  return compound;
}

void RandomGame::make_object() {
  if (objects_.size() >= 4) return;
  btCollisionShape* shape = nullptr;
  switch (random_.below(3)) {
    case 0: {
      auto* mesh = new btTriangleMesh;
      meshes_.emplace_back(mesh);
      const btVector3 a(bt(-0.3), bt(-0.1), bt(-0.3)), b(bt(0.3), bt(-0.1), bt(-0.3)),
          c(0, bt(-0.12), bt(0.3));
      mesh->addTriangle(a, c, b);
      mesh->addTriangle(c + place(0.2), a, b);
      shapes_.emplace_back(shape = new btBvhTriangleMeshShape(mesh, true));
      break;
    }
    case 1:
      shapes_.emplace_back(shape = new btStaticPlaneShape(btVector3(0, 1, 0), bt(-0.15)));
      break;
    case 2:
      shape = new_shape();
  }
  objects_.push_back(std::make_unique<btCollisionObject>());
  objects_.back()->setCollisionShape(shape);
  if (!shape->isConcave()) objects_.back()->setWorldTransform(pose());
  bullet_.world.addCollisionObject(objects_.back().get());
}

void RandomGame::attach_object() {
  if (objects_.empty()) return make_object();
  if (once_in(6)) return solver_->removeCollisionObject(&any(objects_));
  note(solver_->addCollisionObject(&any(objects_), number(0.002, 0.006)));
}

void RandomGame::change_object() {
  if (objects_.empty()) return;
  btCollisionObject& object = any(objects_);
  if (once_in(3))
    object.setCollisionFlags(object.getCollisionFlags() ^ btCollisionObject::CF_NO_CONTACT_RESPONSE);
  else
    object.setWorldTransform(pose());
  if (once_in(3)) solver_->resetMotion(&object);
}

void RandomGame::delete_object() {
  if (objects_.empty() || !once_in(3)) return;
  destroy(take_any(objects_));
}

// --- rigid bodies

void RandomGame::make_body() {
  if (bodies_.size() >= 4) return;
  btCollisionShape* shape = new_shape();
  const btScalar mass = once_in(5) ? 0 : bt(random_.log_uniform(1e-3, 10));
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia_of(*shape, mass));
  info.m_startWorldTransform = pose();
  bodies_.push_back(std::make_unique<btRigidBody>(info));
  bullet_.world.addRigidBody(bodies_.back().get());
}

void RandomGame::attach_body() {
  if (bodies_.empty()) return make_body();
  if (once_in(6)) return solver_->removeRigidBody(&any(bodies_));
  note(solver_->addRigidBody(&any(bodies_), number(0.002, 0.006)));
}

void RandomGame::change_body() {
  if (bodies_.empty()) return;
  btRigidBody& body = any(bodies_);
  switch (random_.below(5)) {
    case 0:
      body.applyCentralImpulse(place(0.2));
      return body.activate();
    case 1:
      body.setWorldTransform(pose());
      body.setInterpolationWorldTransform(body.getWorldTransform());
      return once_in(2) ? solver_->resetMotion(&body) : void();
    case 2:
      return body.setLinearFactor(btVector3(bt(random_.below(2)), 1, bt(random_.below(2))));
    case 3:
      return body.setCollisionFlags(body.getCollisionFlags() ^ btCollisionObject::CF_KINEMATIC_OBJECT);
    case 4: {
      const btScalar mass = once_in(3) ? 0 : bt(random_.uniform(0.01, 1));
      body.setMassProps(mass, inertia_of(*body.getCollisionShape(), mass));
    }
  }
}

void RandomGame::delete_body() {
  if (bodies_.empty() || !once_in(3)) return;
  destroy(take_any(bodies_));
}

// --- cloth

void RandomGame::make_cloth() {
  if (cloths_.size() >= 3) return;
  const int nodes = 3 + static_cast<int>(random_.below(8));
  cloths_.push_back(bullet_.patch(nodes, random_.uniform(0.2, 0.5), random_.uniform(-0.1, 0.1),
                                  static_cast<int>(random_.below(16)), random_.log_uniform(1e-3, 1)));
}

void RandomGame::attach_cloth() {
  if (cloths_.empty()) return make_cloth();
  btSoftBody* cloth = cloths_[index_in(cloths_)];
  if (once_in(6)) return solver_->removeCloth(cloth);
  SurfaceSettings settings;
  settings.thickness = static_cast<double>(number(0.002, 0.012));
  settings.slip.model = static_cast<SlipModel>(random_.below(4));
  note(solver_->addCloth(cloth, settings, once_in(2), once_in(2)));
}

void RandomGame::change_cloth() {
  if (cloths_.empty()) return;
  btSoftBody& cloth = *cloths_[index_in(cloths_)];
  const auto node = [&] {
    return static_cast<int>(random_.below(static_cast<std::uint32_t>(cloth.m_nodes.size())));
  };
  switch (random_.below(7)) {
    case 0:
      static_cast<void>(cloth.cutLink(node(), node(), bt(0.5)));
      return;
    case 1:
      return cloth.setMass(node(), once_in(3) ? 0 : bt(random_.uniform(1e-4, 0.01)));
    case 2:
      cloth.translate(place(0.05));
      return once_in(2) ? solver_->resetMotion(&cloth) : void();
    case 3:
      cloth.m_nodes[node()].m_v = place(3);
      return;
    case 4: {
      const int a = node(), b = node();
      cloth.appendNode(cloth.m_nodes[a].m_x + place(0.02), bt(0.001));
      return cloth.appendFace(a, b, cloth.m_nodes.size() - 1);
    }
    case 5:
      if (cloth.m_faces.size() > 4) cloth.m_faces.pop_back();
      return;
    case 6:
      return cloth.setVelocity(place(2));
  }
}

/// What is deleted without a word to the solver is detached in the next sub-step, which must come first.
void RandomGame::delete_cloth() {
  if (cloths_.empty() || !once_in(3)) return;
  btSoftBody* const cloth = take_any(cloths_);
  const bool silent = !is_within_call_ && once_in(2);
  if (!silent) solver_->removeCloth(cloth);
  bullet_.destroy(cloth);
  if (silent) step();
}

// --- states and settings

void RandomGame::save() {
  is_saved_with_world_ = once_in(2);
  const Status status = solver_->saveState(&saved_, is_saved_with_world_ ? &bullet_.world : nullptr);
  note(status);
  if (!status.ok()) saved_.clear();
}

void RandomGame::restore() {
  if (saved_.empty()) return save();
  std::vector<std::uint8_t> bytes = saved_;
  const auto size = static_cast<std::uint32_t>(bytes.size());
  if (once_in(4)) bytes[random_.below(size)] ^= static_cast<std::uint8_t>(1u << random_.below(8));
  if (once_in(6)) bytes.resize(random_.below(size));
  note(solver_->restoreState(bytes, is_saved_with_world_ ? &bullet_.world : nullptr));
}

void RandomGame::translate() {
  note(solver_->translate(once_in(6) ? btVector3(number(-1, 1), 0, 0) : place(0.05)));
}

void RandomGame::change_settings() {
  switch (random_.below(7)) {
    case 0:
      return solver_->setCollisionWorld(once_in(2) ? &bullet_.world : nullptr);
    case 1:
      return solver_->setCouplingInterval(1 + static_cast<int>(random_.below(3)));
    case 2:
      return note(solver_->getCoupling().setTouchHold(number(0, 0.05)));
    case 3:
      return solver_->setCarriesWater(once_in(2));
    case 4:
      solver_->getCoupling().setUseClothGravity(once_in(2));
      return fluid() ? note(fluid()->setGravity(place(10))) : void();
    case 5:
      static_cast<void>(solver_->takeReport());
      static_cast<void>(solver_->takeMessages());
      return;
    case 6:
      note(solver_->getCoupling().step(number(0.001, 0.003)).status);
  }
}

}  // namespace oilskin::bullet::test
