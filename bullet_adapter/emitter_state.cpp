#include "emitter_state.h"

#include "bullet_archive.h"

namespace oilskin::bullet {

namespace {

EmitterMemory::Kind kind_of(const btFluidEmitter& emitter) {
  using Kind = EmitterMemory::Kind;
  if (dynamic_cast<const btFluidDiscEmitter*>(&emitter)) return Kind::disc;
  if (dynamic_cast<const btFluidBoxEmitter*>(&emitter)) return Kind::box;
  if (dynamic_cast<const btFluidMeshEmitter*>(&emitter)) return Kind::mesh;
  return dynamic_cast<const btFluidRainEmitter*>(&emitter) ? Kind::rain : Kind::other;
}

}  // namespace

void EmitterMemory::capture(const btFluidEmitter& emitter) {
  kind = kind_of(emitter);
  transform = emitter.m_transform;
  speed = emitter.m_speed;
  enabled = emitter.m_enabled;
  inherited_velocity = emitter.m_inheritedVelocity;
  id = emitter.m_id.value;
  volume_before = emitter.m_volumeBefore;
  is_placed = emitter.m_isPlaced;
  added_at = emitter.m_addedAt;
  if (const auto* rain = dynamic_cast<const btFluidRainEmitter*>(&emitter))
    drops_per_second = rain->m_dropsPerSecond;
}

void EmitterMemory::visit(Archive& archive) {
  archive.values(kind, enabled, id, volume_before, is_placed, added_at);
  bullet::visit(archive, transform);
  for (btScalar* x : {&speed, &drops_per_second}) bullet::visit(archive, *x);
  bullet::visit(archive, inherited_velocity);
}

Status EmitterMemory::check(const btFluidEmitter& emitter) const {
  return kind == kind_of(emitter) ? Status::accepted()
                                  : Status::refused("is of another kind than the saved one");
}

void EmitterMemory::apply(btFluidEmitter& emitter) const {
  emitter.m_transform = transform;
  emitter.m_speed = speed;
  emitter.m_enabled = enabled;
  emitter.m_inheritedVelocity = inherited_velocity;
  emitter.m_id.value = id;
  emitter.m_volumeBefore = volume_before;
  emitter.m_isPlaced = is_placed;
  emitter.m_addedAt = added_at;
  if (auto* rain = dynamic_cast<btFluidRainEmitter*>(&emitter)) rain->m_dropsPerSecond = drops_per_second;
}

void SinkMemory::capture(const btFluidSink& sink) {
  id = sink.m_id.value;
  taken_before = sink.m_takenBefore;
  volume_before = sink.m_volumeBefore;
}

void SinkMemory::apply(btFluidSink& sink) const {
  sink.m_id.value = id;
  sink.m_takenBefore = taken_before;
  sink.m_volumeBefore = volume_before;
}

void ForceMemory::capture(const btFluidForce& force) {
  id = force.m_id.value;
  kind = static_cast<std::uint32_t>(force.m_force.index());
}

Status ForceMemory::check(const btFluidForce& force) const {
  return kind == force.m_force.index() ? Status::accepted()
                                       : Status::refused("is of another kind than the saved one");
}

void ForceMemory::apply(btFluidForce& force) const {
  force.m_id.value = id;
}

}  // namespace oilskin::bullet
