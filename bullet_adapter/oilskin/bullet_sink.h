/// @file
/// Sinks as objects of Bullet's kind: the user creates, moves and owns them, and adds them to a btFluid.
#pragma once

#include "oilskin/bullet.h"

namespace oilskin::bullet {

/// Where particles end. A sink is in at most one fluid; either may be deleted first. Call it between steps.
/// Refusals change nothing. World::add_sink() says when a particle ends in it.
class btFluidSink {
 public:
  /// A convex shape, as in btFluid::removeParticles(), which is copied. What has no volume is refused by
  /// btFluid::addSink().
  explicit btFluidSink(const btConvexShape* shape);
  ~btFluidSink();
  btFluidSink(const btFluidSink&) = delete;
  btFluidSink& operator=(const btFluidSink&) = delete;

  /// The sink is there from the next step on. Refuses a transform that is not finite or not a rigid motion.
  Status setWorldTransform(const btTransform& transform);
  /// Where it is.
  btTransform getWorldTransform() const;
  /// Whether it takes particles (default).
  Status setEnabled(bool enabled);
  /// Whether it takes particles.
  bool isEnabled() const;

  /// The number of particles that have ended in it, in all fluids that it was in.
  std::uint64_t getTakenParticles() const;
  /// Their volume at the rest density [m³].
  btScalar getTakenVolume() const;
  /// The fluid that it is in; null = none.
  btFluid* getFluid() const { return m_fluid; }
  /// Its handle in the fluid's world; none without a fluid.
  SinkId getSinkId() const { return m_id; }

 private:
  friend class btFluid;
  friend struct SinkMemory;
  Status attach(btFluid* fluid);
  void detach();
  std::optional<SinkState> state() const;

  Region m_region;
  Status m_status;
  btTransform m_transform = btTransform::getIdentity();
  bool m_enabled = true;
  btFluid* m_fluid = nullptr;
  SinkId m_id;
  std::uint64_t m_takenBefore = 0;
  double m_volumeBefore = 0;
};

}  // namespace oilskin::bullet
