/// What emitters remember beside the world, in saved states.
#pragma once

#include "core/archive.h"
#include "oilskin/bullet_emitter.h"

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

  void capture(const btFluidEmitter& emitter);
  void visit(Archive& archive);
  /// Refuses an emitter of another kind.
  Status check(const btFluidEmitter& emitter) const;
  void apply(btFluidEmitter& emitter) const;
};

}  // namespace oilskin::bullet
