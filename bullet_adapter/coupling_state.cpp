// The whole state of a coupling as bytes (docs/manual/saving.md).
#include <algorithm>

#include "bullet_archive.h"
#include "core/frame.h"
#include "coupling_impl.h"
#include "emitter_state.h"
#include "object_state.h"
#include "pair_state.h"
#include "report_archive.h"

namespace oilskin::bullet {

namespace {

constexpr FrameKind saved_state = {{'O', 'I', 'L', 'S', 'T', 'A', 'T', 'E'}, 5, "saved state"};

/// Of one attached object.
struct AttachmentState {
  enum class Kind : std::uint8_t { cloth, rigid_body, object, sensor };
  Kind kind = Kind::object;
  std::vector<std::uint64_t> order;  // of its surface among those of each fluid; 0 = it has none
  ObjectState object;
  Touched touched;
  SoftState soft;  // of a cloth
  SoftBodyHost::State soft_host;
  CollisionObjectHost::State host;  // of what is no cloth
  std::optional<RigidState> rigid;
  Sensor::State sensor;
};

struct FluidState {
  std::vector<std::uint8_t> world;
  std::vector<EmitterMemory> emitters;
  std::vector<SinkMemory> sinks;
  std::vector<ForceMemory> forces;
};

struct CouplingState {
  std::vector<FluidState> fluids;
  std::vector<AttachmentState> attachments;
  bool use_cloth_gravity = true, carries_water = true, stepped_by_solver = false;
  std::optional<Vec3> followed_gravity;
  int pending = 0;
  double pending_time = 0, touch_hold = 0;
  std::vector<std::string> messages;
  StepReport refused, sum;
  std::optional<PairState> contacts;  // of the world
};

AttachmentState::Kind kind_of(const Attachment& a) {
  using Kind = AttachmentState::Kind;
  if (a.cloth) return Kind::cloth;
  if (a.sensor) return Kind::sensor;
  return a.takes_impulses ? Kind::rigid_body : Kind::object;
}

const char* name_of(AttachmentState::Kind kind) {
  const char* names[] = {"a cloth", "a rigid body", "a collision object", "a sensor"};
  return names[static_cast<std::size_t>(kind)];
}

/// Of the surface of `a` among those of each fluid, from 1.
std::vector<std::uint64_t> surface_order(const std::vector<Attachment>& attachments, const Attachment& a) {
  std::vector<std::uint64_t> order;
  for (std::size_t k = 0; k < a.ids.size(); ++k) {
    const auto is_before = [&](const Attachment& b) { return b.ids[k] && b.ids[k].value <= a.ids[k].value; };
    const auto place = std::count_if(attachments.begin(), attachments.end(), is_before);
    order.push_back(a.ids[k] ? static_cast<std::uint64_t>(place) : 0);
  }
  return order;
}

// --- writing and reading

void visit_soft_host(Archive& archive, SoftBodyHost::State& state) {
  archive.values(state.forget_motion, state.contact_node, state.contact_nodes, state.node_impulse,
                 state.dry_mass, state.weighed);
}

void visit_sensor(Archive& archive, Sensor::State& state) {
  archive.optional(state.to_local, [&](Eigen::Affine3d& transform) {
    for (double& entry : transform.matrix().reshaped()) archive.value(entry);
    if (!transform.matrix().allFinite()) archive.refuse("the transform of a sensor is not finite");
  });
  archive.value(state.teleported);
  archive.list(state.inside, 8, [&](std::vector<std::uint64_t>& inside) { archive.value(inside); });
  auto& [particles, volume, flow] = state.reading;
  auto& [entered, left, passed, appeared, vanished, entered_volume, left_volume] = flow;
  archive.values(particles, volume, entered, left, passed, appeared, vanished, entered_volume, left_volume);
  for (const std::vector<std::uint64_t>& inside : state.inside)
    archive.require(std::is_sorted(inside.begin(), inside.end()), "what is in a sensor");
}

void visit_attachment(Archive& archive, AttachmentState& state) {
  archive.values(state.kind, state.order);
  archive.require(state.kind <= AttachmentState::Kind::sensor, "the kind of an object");
  state.object.visit(archive);
  auto& [total, is_touched, since_touch] = state.touched;
  archive.values(total.impulse, total.angular_impulse, is_touched, since_touch);
  if (state.kind == AttachmentState::Kind::cloth) {
    state.soft.visit(archive);
    return visit_soft_host(archive, state.soft_host);
  }
  archive.value(state.host.forget_motion);
  visit(archive, state.host.start);
  archive.optional(state.rigid, [&](RigidState& rigid) { rigid.visit(archive); });
  if (state.kind == AttachmentState::Kind::sensor) visit_sensor(archive, state.sensor);
}

void visit_fluid(Archive& archive, FluidState& state) {
  constexpr std::size_t of_emitter = 50, of_sink = 24, of_force = 12;  // at least [bytes]
  archive.value(state.world);
  archive.list(state.emitters, of_emitter, [&](EmitterMemory& emitter) { emitter.visit(archive); });
  archive.list(state.sinks, of_sink, [&](SinkMemory& sink) { sink.visit(archive); });
  archive.list(state.forces, of_force, [&](ForceMemory& force) { force.visit(archive); });
}

void visit_state(Archive& archive, CouplingState& state) {
  auto& [fluids, attachments, use_cloth_gravity, carries_water, stepped_by_solver, followed_gravity, pending,
         pending_time, touch_hold, messages, refused, sum, contacts] = state;
  constexpr std::size_t of_fluid = 32, of_attachment = 100;  // at least [bytes]
  std::uint8_t scalar = sizeof(btScalar);
  archive.value(scalar);
  if (archive.ok() && scalar != sizeof(btScalar))
    archive.refuse("it comes from Bullet with the other precision");
  archive.list(fluids, of_fluid, [&](FluidState& fluid) { visit_fluid(archive, fluid); });
  archive.values(use_cloth_gravity, carries_water, stepped_by_solver, pending, pending_time, touch_hold);
  archive.require(pending >= 0 && std::isfinite(pending_time) && pending_time >= 0,
                  "the time since a coupling");
  archive.require(std::isfinite(touch_hold) && touch_hold >= 0, "the time that a touch is held");
  archive.list(attachments, of_attachment, [&](AttachmentState& a) {
    visit_attachment(archive, a);
    archive.require(a.sensor.inside.size() <= state.fluids.size(), "what is in a sensor");
  });
  archive.optional(followed_gravity, [&](Vec3& gravity) { archive.value(gravity); });
  visit(archive, messages);
  visit(archive, refused);
  visit(archive, sum);
  archive.optional(contacts, [&](PairState& pairs) { pairs.visit(archive); });
}

// --- the state of what is there

Status capture(const Attachment& a, AttachmentState& state) {
  state.kind = kind_of(a);
  state.object.capture(*a.object);
  state.touched = a.touched;
  if (a.cloth) {
    state.soft_host = a.soft->state();
    return state.soft.capture(*a.cloth);
  }
  state.host = a.rigid->state();
  if (const btRigidBody* body = btRigidBody::upcast(a.object)) state.rigid.emplace().capture(*body);
  if (a.sensor) state.sensor = a.sensor->state();
  return Status::accepted();
}

Status about(const char* what, std::size_t index, const Status& status) {
  return Status::refused(std::string(what) + " " + std::to_string(index + 1) + " " + status.message);
}

Status check(const AttachmentState& state, const Attachment& a) {
  const AttachmentState::Kind kind = kind_of(a);
  if (state.kind != kind)
    return Status::refused(std::string("is ") + name_of(kind) + ", and was " + name_of(state.kind) +
                           " in the saved state; attach the same objects in the same order");
  if (a.cloth) {
    const Status status = state.soft.check(*a.cloth);
    return status.ok() ? a.soft->check(state.soft_host) : status;
  }
  const btRigidBody* body = btRigidBody::upcast(a.object);
  if (state.rigid.has_value() != (body != nullptr))
    return Status::refused("is a btRigidBody here or in the saved state, but not in both");
  return body ? state.rigid->check(*body) : Status::accepted();
}

void apply(AttachmentState& state, Attachment& a) {
  state.object.apply(*a.object);
  a.touched = state.touched;
  if (a.cloth) {
    state.soft.apply(*a.cloth);
    return a.soft->set_state(std::move(state.soft_host));
  }
  if (btRigidBody* body = btRigidBody::upcast(a.object)) state.rigid->apply(*body);
  a.rigid->set_state(state.host);
  if (a.sensor) a.sensor->set_state(std::move(state.sensor));
}

Status check_counts(const char* what, std::size_t saved, std::size_t here) {
  if (saved == here) return Status::accepted();
  return Status::refused("the saved state has " + std::to_string(saved) + " " + what + ", the coupling " +
                         std::to_string(here) + "; add the same ones in the same order");
}

Status check_number_of_fluids(std::size_t saved, std::size_t here) {
  if (saved == here) return Status::accepted();
  if (saved == 0) return Status::refused("the saved state has no fluid");
  const std::string has =
      "the saved state has " + (saved == 1 ? "a fluid" : std::to_string(saved) + " fluids");
  if (here == 0) return Status::refused(has + ": call addFluid() first");
  return Status::refused(has + ", the coupling " + std::to_string(here));
}

Status check_attachments(const std::vector<AttachmentState>& saved, const std::vector<Attachment>& here) {
  if (Status s = check_counts("objects", saved.size(), here.size()); !s.ok()) return s;
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (Status s = check(saved[i], here[i]); !s.ok()) return about("object", i, s);
    if (saved[i].order != surface_order(here, here[i]))
      return Status::refused("the surfaces were added to the fluid in another order than in the saved state");
  }
  return Status::accepted();
}

/// Of emitters or forces: `what` with an s for several.
template <class Memory, class Object>
Status check_each(const std::string& what, const std::vector<Memory>& saved,
                  const std::vector<Object*>& here) {
  if (Status s = check_counts((what + "s").c_str(), saved.size(), here.size()); !s.ok()) return s;
  for (std::size_t i = 0; i < here.size(); ++i)
    if (Status s = saved[i].check(*here[i]); !s.ok()) return about(what.c_str(), i, s);
  return Status::accepted();
}

/// All of them or none.
Status restore_worlds(const std::vector<FluidState>& saved, const std::vector<World*>& worlds) {
  std::vector<std::vector<std::uint8_t>> before(worlds.size());
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    Status status;
    if (k + 1 < worlds.size()) status = worlds[k]->save(&before[k]);
    if (status.ok()) status = worlds[k]->restore(saved[k].world);
    if (status.ok()) continue;
    for (std::size_t done = 0; done < k; ++done) static_cast<void>(worlds[done]->restore(before[done]).ok());
    return worlds.size() == 1 ? status : about("fluid", k, status);
  }
  return Status::accepted();
}

}  // namespace

std::vector<const btCollisionObject*> btFluidCoupling::Impl::attached_objects() const {
  std::vector<const btCollisionObject*> objects;
  for (const Attachment& a : attachments) objects.push_back(a.object);
  return objects;
}

Status btFluidCoupling::saveState(std::vector<std::uint8_t>* out, btCollisionWorld* world) const {
  if (!out) return Status::refused("saveState() needs a vector to write to, and `out` is null");
  const Impl& c = *m_impl;
  if (Status s = c.check_between_steps(); !s.ok()) return s;
  CouplingState state;
  for (const btFluid* fluid : c.fluids) {
    FluidState& f = state.fluids.emplace_back();
    if (Status s = fluid->getWorld().save(&f.world); !s.ok()) return s;
    for (const btFluidEmitter* emitter : fluid->m_emitters) f.emitters.emplace_back().capture(*emitter);
    for (const btFluidSink* sink : fluid->m_sinks) f.sinks.emplace_back().capture(*sink);
    for (const btFluidForce* force : fluid->m_forces) f.forces.emplace_back().capture(*force);
  }
  for (std::size_t i = 0; i < c.attachments.size(); ++i) {
    AttachmentState& a = state.attachments.emplace_back();
    if (Status s = capture(c.attachments[i], a); !s.ok()) return about("object", i, s);
    a.order = surface_order(c.attachments, c.attachments[i]);
  }
  state.use_cloth_gravity = c.use_cloth_gravity, state.carries_water = c.carries_water;
  state.stepped_by_solver = c.stepped_by_solver, state.followed_gravity = c.followed_gravity;
  state.pending = c.pending, state.pending_time = c.pending_time, state.touch_hold = c.listening.touch_hold;
  state.messages = c.messages, state.refused = c.refused, state.sum = c.listening.sum;
  if (world)
    if (Status s = state.contacts.emplace().capture(*world, c.attached_objects()); !s.ok()) return s;
  std::vector<std::uint8_t> content;
  Archive archive(content);
  visit_state(archive, state);
  if (!archive.ok()) return Status::refused("the state cannot be saved: " + archive.status().message);
  *out = framed(saved_state, content);
  return Status::accepted();
}

Status btFluidCoupling::restoreState(Span<const std::uint8_t> saved, btCollisionWorld* world) {
  Impl& c = *m_impl;
  if (Status s = c.check_between_steps(); !s.ok()) return s;
  Span<const std::uint8_t> content;
  if (Status s = unframe(saved_state, saved, &content); !s.ok()) return s;
  CouplingState state;
  Archive archive(content);
  visit_state(archive, state);
  if (archive.ok() && archive.left() > 0) archive.refuse("there are more bytes than there is state");
  if (!archive.ok()) return Status::refused("the saved state: " + archive.status().message);
  if (Status s = check_number_of_fluids(state.fluids.size(), c.fluids.size()); !s.ok()) return s;
  if (state.contacts.has_value() != (world != nullptr))
    return Status::refused(world ? "the saved state has no contacts of a world"
                                 : "the saved state has the contacts of a world: give the world, too");
  Status status = check_attachments(state.attachments, c.attachments);
  for (std::size_t k = 0; k < c.fluids.size() && status.ok(); ++k) {
    const FluidState& f = state.fluids[k];
    status = check_each("emitter", f.emitters, c.fluids[k]->m_emitters);
    if (status.ok()) status = check_counts("sinks", f.sinks.size(), c.fluids[k]->m_sinks.size());
    if (status.ok()) status = check_each("force", f.forces, c.fluids[k]->m_forces);
  }
  if (status.ok() && world) status = state.contacts->check(*world, c.attached_objects());
  if (status.ok()) status = restore_worlds(state.fluids, c.worlds());
  if (!status.ok()) return status;

  for (std::size_t i = 0; i < state.attachments.size(); ++i) apply(state.attachments[i], c.attachments[i]);
  for (std::size_t k = 0; k < c.fluids.size(); ++k) {
    FluidState& f = state.fluids[k];
    for (std::size_t i = 0; i < f.emitters.size(); ++i) f.emitters[i].apply(*c.fluids[k]->m_emitters[i]);
    for (std::size_t i = 0; i < f.sinks.size(); ++i) f.sinks[i].apply(*c.fluids[k]->m_sinks[i]);
    for (std::size_t i = 0; i < f.forces.size(); ++i) f.forces[i].apply(*c.fluids[k]->m_forces[i]);
  }
  c.joint.reset();
  c.use_cloth_gravity = state.use_cloth_gravity, c.carries_water = state.carries_water;
  c.stepped_by_solver = state.stepped_by_solver, c.followed_gravity = state.followed_gravity;
  c.pending = state.pending, c.pending_time = state.pending_time, c.listening.touch_hold = state.touch_hold;
  c.messages = std::move(state.messages), c.refused = std::move(state.refused);
  c.listening.sum = std::move(state.sum);
  c.listening.due.clear();
  const std::size_t lost = world ? state.contacts->apply(*world) : 0;
  if (lost > 0)
    c.note("the contacts of " + std::to_string(lost) +
           " pairs could not be restored, and Bullet finds them anew");
  return status;
}

}  // namespace oilskin::bullet
