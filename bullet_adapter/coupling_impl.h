/// Data of btFluidCoupling.
#pragma once

#include <optional>

#include "collision_object_host.h"
#include "listening.h"
#include "object_mark.h"
#include "oilskin/bullet.h"
#include "rigid_body_host.h"
#include "sensor.h"
#include "soft_body_host.h"

namespace oilskin::bullet {

/// An attached object. Exactly one of the hosts is set.
struct Attachment {
  btCollisionObject* object = nullptr;
  btSoftBody* cloth = nullptr;  ///< the object, if it is a cloth
  std::unique_ptr<SoftBodyHost> soft;
  std::unique_ptr<CollisionObjectHost> rigid;
  std::unique_ptr<ObjectMark> mark;
  bool takes_impulses = false;  ///< a rigid body
  SurfaceSettings settings;
  std::unique_ptr<Sensor> sensor;  ///< null = a wall
  bool measures = false;           ///< a sensor that takes part in the present step
  std::vector<SurfaceId> ids;      ///< in each fluid; 0 for a sensor
  std::uint64_t number = 0;        ///< no other attachment of its coupling has it
  Touched touched;

  /// In the first fluid; 0 without one, and for a sensor.
  SurfaceId id() const { return ids.empty() ? SurfaceId() : ids[0]; }
  SurfaceHost& host() { return soft ? static_cast<SurfaceHost&>(*soft) : *rigid; }
};

struct btFluidCoupling::Impl {
  std::vector<btFluid*> fluids;
  std::vector<Attachment> attachments;
  bool use_cloth_gravity = true;
  bool carries_water = true;
  const btCollisionWorld* collision_world = nullptr;
  std::optional<Vec3> followed_gravity;  // as the last step set it
  bool stepped_by_solver = false;        // since the last step by hand
  std::vector<std::string> messages;     // since they were last taken
  StepReport refused;                    // returned by step() if no world was called
  std::optional<StepReport> joint;       // of the last step, if it was of several fluids
  Listening listening;
  std::vector<ParticlesBefore> particles_before;  // of each fluid, with sensors, during a step
  std::uint64_t next_number = 1;
  int pending = 0;          // Bullet's sub-steps since the solver's last coupling
  double pending_time = 0;  // their length [s]

  std::vector<World*> worlds() const;
  /// Of the first fluid; null without one.
  World* world() const { return fluids.empty() ? nullptr : &fluids[0]->getWorld(); }
  /// Which of the fluids it is; nothing for another one. Null is the first.
  std::optional<std::size_t> index_of(const btFluid* fluid) const;
  Box kill_box() const;
  /// Of all fluids [m].
  double finest_spacing() const;
  /// Makes the triangles of a round shape as fine as the fluids need them.
  void refine(Attachment& a);
  std::vector<const btCollisionObject*> attached_objects() const;
  Attachment* find(const btCollisionObject* object);
  Status add(Attachment attachment);
  Status attach(Attachment& attachment, std::size_t fluid);
  Status attach(Attachment& attachment);
  void detach(Attachment& attachment, std::size_t fluid);
  void detach(Attachment& attachment);
  void remove(const btCollisionObject* object);
  /// Of each attachment, whether `present` has it.
  template <class Objects>
  std::vector<char> present_in(const Objects& present) const;
  template <class Objects>
  void detach_absent(const Objects& present, bool cloth_only);
  void detach_absent();
  void detach_deleted(std::size_t attachment);
  void note(const std::string& message);
  void note_drivers(bool by_solver);
  void note_report(const StepReport& report);
  void note_gravity();
  void note_bodies();
  void forget_motion(const btCollisionObject* object);
  const SurfaceMotion* surface(const btCollisionObject* object);
  Status follow_gravity();
  std::optional<Vec3> gravity_of_cloth() const;
  void follow_kill_box();
  const StepReport& refuse(std::string why);

  /// Refuses to save and restore where that is not possible.
  Status check_between_steps() const;

  // coupling_translate.cpp
  void set_planes(const Box& kill_box);
  Status translate_worlds(const btVector3& offset);

  // coupling_listen.cpp
  const btCollisionObject* object_of(std::uint64_t number) const;
  void prepare_sensors();
  void become_wall(Attachment& attachment);
  void hear(const StepReport& report);
  void hear_surfaces(double dt);
  void tell(const FluidEvent& event, btFluidListener& listener);
  const StepReport& refuse_within_call();
};

}  // namespace oilskin::bullet
