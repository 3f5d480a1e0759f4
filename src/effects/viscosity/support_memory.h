/// What the host of a surface holds of the drag on its free nodes, or on its body, learned from the last
/// steps (V.10).
#pragma once

#include "effects/viscosity/channel_vectors.h"

namespace oilskin::effects {

/// With which mean values forget (t_s) [s].
constexpr double memory_time = 0.02;

struct RigidVelocity {
  Vec3 linear = Vec3::Zero();   ///< of the centre of mass [m/s]
  Vec3 angular = Vec3::Zero();  ///< [rad/s]
};

/// The numbers of a node that the world keeps: four vectors, and the time since the step began. A rigid body
/// keeps its own at three nodes of its surface.
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
  /// The velocities at which a dynamic body goes on: those that it has by now, with what gravity took back
  /// meanwhile of the loads of this step, and with the support against the drag of this interval (V.13).
  static RigidVelocity expected_of_body(EffectForces& forces, std::size_t surface);
  /// Adds the change by the drag in this interval.
  static void record_of_body(EffectForces& forces, std::size_t surface, const RigidVelocity& change);
};

}  // namespace oilskin::effects
