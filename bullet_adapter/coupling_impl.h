/// Data of btFluidCoupling.
#pragma once

#include "collision_object_host.h"
#include "oilskin/bullet.h"
#include "soft_body_host.h"

namespace oilskin::bullet {

/// An attached object. Exactly one of the hosts is set.
struct Attachment {
  const btCollisionObject* object = nullptr;
  btSoftBody* cloth = nullptr;  ///< the object, if it is a cloth
  std::unique_ptr<SoftBodyHost> soft;
  std::unique_ptr<CollisionObjectHost> rigid;
  SurfaceSettings settings;
  SurfaceId id;  ///< 0 without a fluid

  SurfaceHost& host() { return soft ? static_cast<SurfaceHost&>(*soft) : *rigid; }
};

struct btFluidCoupling::Impl {
  btFluid* fluid = nullptr;
  std::vector<Attachment> attachments;
  bool use_cloth_gravity = true;
  bool carries_water = true;
  StepReport refused;  // returned by step() if World::step was not called

  World* world() const { return fluid ? &fluid->getWorld() : nullptr; }
  Attachment* find(const btCollisionObject* object);
  Status add(Attachment attachment);
  Status attach(Attachment& attachment);
  void detach(Attachment& attachment);
  void remove(const btCollisionObject* object);
  void forget_motion(const btCollisionObject* object);
  const SurfaceMotion* surface(const btCollisionObject* object);
  Status follow_gravity();
  const StepReport& refuse(std::string why);
};

}  // namespace oilskin::bullet
