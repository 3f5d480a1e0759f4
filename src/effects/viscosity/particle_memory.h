/// What the world keeps of each particle: its last drag, and what acts on it beside known forces (V.12).
#pragma once

#include "effects/viscosity/channel_vectors.h"

namespace oilskin::effects {

class ParticleMemory {
 public:
  static constexpr std::size_t channels = 10;

  explicit ParticleMemory(EffectForces& forces);

  /// First of an interval: compares the velocities with those that known forces and drag would have given.
  void learn() const;
  /// By drag, in the last interval [m/s²].
  Vec3 last_drag(std::size_t i) const { return drag_.get(i); }
  /// By pressure and contact, expected in this interval: the mean of the particle and its neighbours [m/s²].
  Vec3 expected(std::size_t i) const;
  /// The acceleration by drag, which forces.acceleration has already [m/s²].
  void record(std::size_t i, const Vec3& drag) const;

 private:
  EffectForces& forces_;
  ChannelVectors drag_, free_, rest_;
  Span<double> time_;  // of free_ [s]; 0 = none
};

}  // namespace oilskin::effects
