/// What the host of a surface holds of the drag on its free nodes, learned from the last intervals (V.10).
#pragma once

#include <vector>

#include "oilskin/effect.h"

namespace oilskin::effects {

/// The numbers of a node that the world keeps, three each.
class SupportMemory {
 public:
  static constexpr std::size_t channels = 12;

  /// First of an interval: compares the motion that hosts propose with what the last drag alone would do.
  static void learn(EffectForces& forces);
  /// The force by which the host is expected to hold a node against the drag [N].
  static Vec3 support(EffectForces& forces, std::size_t surface, std::uint32_t node);
  /// The drag on a node in this interval [N]. learn() has set it to zero.
  static void record(EffectForces& forces, std::size_t surface, std::uint32_t node, const Vec3& drag);
};

}  // namespace oilskin::effects
