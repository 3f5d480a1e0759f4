/// What the pins of cloth give it.
#pragma once

#include "checks/check.h"

namespace oilskin::demo {

/// The impulse of the pins is the change of momentum of the free nodes, less gravity and the water, plus what
/// the water gave to pinned nodes directly. Links are internal to the cloth. The fluid's momentum is not
/// used.
class PinImpulse {
 public:
  /// To be called after every step.
  void after_step(const Moment& now);

  /// Of the pins of all cloth on it, in the last step [N s]. In the first step the change of the nodes is not
  /// known yet.
  const Vec3& last() const { return last_; }
  /// Of the free nodes [kg].
  double free_mass() const { return free_mass_; }

 private:
  void add(const SurfaceMotion& motion, std::vector<Vec3>& velocity_before);

  Vec3 last_ = Vec3::Zero();
  double free_mass_ = 0;
  std::vector<std::vector<Vec3>> velocity_before_;  // per cloth, as the last step left them [m/s]
};

}  // namespace oilskin::demo
