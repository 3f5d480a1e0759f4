/// Emitters of a world, and what their owners change between steps.
#include <sstream>

#include "world/world_impl.h"

namespace oilskin {

namespace {

Status check_inside(const Box& kill_box, const Box& emitter) {
  // Positions that are not finite are refused by Emission, with a better message.
  if (!emitter.min.allFinite() || !emitter.max.allFinite() || kill_box.overlaps(emitter)) return {};
  std::ostringstream s;
  s << "the emitter, at (" << emitter.min.transpose() << ") m, lies outside the kill box ("
    << kill_box.min.transpose() << ") … (" << kill_box.max.transpose() << ") m, where nothing lives";
  return Status::refused(s.str());
}

Box extent(const DiscEmitter& e) {
  return Box{e.center, e.center};
}
Box extent(const BoxEmitter& e) {
  return e.box;
}
Box extent(const MeshEmitter& e) {
  Box box;
  for (const Vec3& x : e.vertices) box.add(x);
  return box;
}
Box extent(const RainEmitter& e) {
  Box box;
  for (const Vec3& x :
       {e.corner, Vec3(e.corner + e.edge_u), Vec3(e.corner + e.edge_v), Vec3(e.corner + e.edge_u + e.edge_v)})
    box.add(x);
  return box;
}

/// Where a box around the emitter's points is at a pose; its centre is the emitter's.
Box moved(const Box& extent, const EmitterPose& pose) {
  const Eigen::Matrix3d turn = pose.rotation.normalized().toRotationMatrix();
  const Vec3 half = turn.cwiseAbs() * (0.5 * (extent.max - extent.min));
  return {pose.position - half, pose.position + half};
}

}  // namespace

template <class Emitter>
Status World::Impl::add(const Emitter& e, EmitterId* id, const EmitterPose* pose) {
  if (!status.ok()) return status;
  const Box box = pose ? moved(extent(e), *pose) : extent(e);
  if (Status inside = check_inside(settings.kill_box, box); !inside.ok()) return inside;
  return emission->add(e, pose, id ? &id->value : nullptr);
}

Status World::add_emitter(const DiscEmitter& e, EmitterId* id, const EmitterPose* pose) {
  return impl_->add(e, id, pose);
}
Status World::add_emitter(const BoxEmitter& e, EmitterId* id, const EmitterPose* pose) {
  return impl_->add(e, id, pose);
}
Status World::add_emitter(const MeshEmitter& e, EmitterId* id, const EmitterPose* pose) {
  return impl_->add(e, id, pose);
}
Status World::add_emitter(const RainEmitter& e, EmitterId* id, const EmitterPose* pose) {
  return impl_->add(e, id, pose);
}

Status World::move_emitter(EmitterId id, const EmitterPose& pose, double duration) {
  const fluid::Emission::Motion motion = {time(), duration, false};
  return impl_->status.ok() ? impl_->emission->move(id.value, pose, motion) : impl_->status;
}

Status World::move_emitter(EmitterId id, const Vec3& center, const Vec3& direction, double duration) {
  const fluid::Emission::Motion motion = {time(), duration, false};
  return impl_->status.ok() ? impl_->emission->aim(id.value, center, direction, motion) : impl_->status;
}

Status World::place_emitter(EmitterId id, const EmitterPose& pose) {
  const fluid::Emission::Motion motion = {time(), 0, true};
  return impl_->status.ok() ? impl_->emission->move(id.value, pose, motion) : impl_->status;
}

Status World::place_emitter(EmitterId id, const Vec3& center, const Vec3& direction) {
  const fluid::Emission::Motion motion = {time(), 0, true};
  return impl_->status.ok() ? impl_->emission->aim(id.value, center, direction, motion) : impl_->status;
}

Status World::set_emitter_speed(EmitterId id, double speed) {
  return impl_->status.ok() ? impl_->emission->set_speed(id.value, speed, time()) : impl_->status;
}

Status World::set_emitter_enabled(EmitterId id, bool enabled) {
  return impl_->status.ok() ? impl_->emission->set_enabled(id.value, enabled, time()) : impl_->status;
}

Status World::set_drops_per_second(EmitterId id, double rate) {
  return impl_->status.ok() ? impl_->emission->set_drops_per_second(id.value, rate, time()) : impl_->status;
}

Status World::set_inherited_velocity(EmitterId id, const Vec3& velocity) {
  return impl_->status.ok() ? impl_->emission->set_inherited_velocity(id.value, velocity) : impl_->status;
}

bool World::remove_emitter(EmitterId id) {
  return impl_->status.ok() && impl_->emission->remove(id.value);
}

std::optional<EmitterState> World::emitter(EmitterId id) const {
  return impl_->status.ok() ? impl_->emission->state(id.value) : std::nullopt;
}

}  // namespace oilskin
