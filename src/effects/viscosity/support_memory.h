/// What the host of a surface holds of the drag on its free nodes, learned from the last steps (V.10).
#pragma once

#include <vector>

#include "oilskin/effect.h"

namespace oilskin::effects {

/// The numbers of a node that the world keeps: four vectors, and the time since the step began.
class SupportMemory {
 public:
  static constexpr std::size_t channels = 13;

  /// First of an interval. Where a step begins, compares the motion that hosts propose with what the drag of
  /// the last step alone would do.
  static void learn(EffectForces& forces);
  /// The impulse that a node has from the drag in this step so far, and from its host, which is expected to
  /// hold it against the drag, to the end of this interval [N s]. The host's motion does not show them yet.
  static Vec3 given(EffectForces& forces, std::size_t surface, std::uint32_t node);
  /// Adds the drag on a node in this interval [N s].
  static void record(EffectForces& forces, std::size_t surface, std::uint32_t node, const Vec3& drag);
};

}  // namespace oilskin::effects
