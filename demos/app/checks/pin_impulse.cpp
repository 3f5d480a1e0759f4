#include "checks/pin_impulse.h"

#include "checks/node_mass.h"

namespace oilskin::demo {

void PinImpulse::after_step(const Moment& now) {
  velocity_before_.resize(now.scene.cloth.size());
  last_.setZero();
  free_mass_ = 0;
  for (std::size_t c = 0; c < now.scene.cloth.size(); ++c) {
    const SurfaceMotion* motion = now.simulation.cloth(c);
    if (motion != nullptr) add(*motion, velocity_before_[c]);
  }
  last_ -= free_mass_ * now.scene.world.gravity * now.dt;
}

void PinImpulse::add(const SurfaceMotion& motion, std::vector<Vec3>& velocity_before) {
  const bool known = velocity_before.size() == motion.velocity.size();
  for (std::size_t i = 0; i < motion.velocity.size() && known; ++i) {
    // A pin takes the impulse on a pinned node; the change of a free node contains its own.
    last_ -= motion.impulse[i];
    if (motion.inverse_mass[i] == 0) continue;
    const double m = node_mass(motion, i);
    last_ += m * (motion.velocity[i] - velocity_before[i]);
    free_mass_ += m;
  }
  velocity_before = motion.velocity;
}

}  // namespace oilskin::demo
