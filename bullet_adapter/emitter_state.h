/// What emitters, sinks and forces remember beside the world, in saved states.
#pragma once

#include "core/archive.h"
#include "oilskin/bullet_emitter.h"
#include "oilskin/bullet_force.h"
#include "oilskin/bullet_sink.h"

namespace oilskin::bullet {

struct EmitterMemory {
  enum class Kind : std::uint8_t { disc, box, mesh, rain, other };
  Kind kind = Kind::other;
  btTransform transform;
  btScalar speed = 0, drops_per_second = 0;
  bool enabled = true;
  btVector3 inherited_velocity;
  std::uint64_t id = 0;
  double volume_before = 0;
  bool is_placed = false;
  double added_at = 0;  // [s]

  void capture(const btFluidEmitter& emitter);
  void visit(Archive& archive);
  /// Refuses an emitter of another kind.
  Status check(const btFluidEmitter& emitter) const;
  void apply(btFluidEmitter& emitter) const;
};

/// The rest of a sink is in the world.
struct SinkMemory {
  std::uint64_t id = 0, taken_before = 0;
  double volume_before = 0;

  void capture(const btFluidSink& sink);
  void visit(Archive& archive) { archive.values(id, taken_before, volume_before); }
  void apply(btFluidSink& sink) const;
};

/// The rest of a force is in the world's effect.
struct ForceMemory {
  std::uint64_t id = 0;
  std::uint32_t kind = 0;

  void capture(const btFluidForce& force);
  void visit(Archive& archive) { archive.values(id, kind); }
  /// Refuses a force of another kind.
  Status check(const btFluidForce& force) const;
  void apply(btFluidForce& force) const;
};

}  // namespace oilskin::bullet
