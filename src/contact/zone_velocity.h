/// The common velocity of an impact zone (docs/theory/contact.md, "Zones").
#pragma once

#include "core/body_motion.h"

namespace oilskin::contact {

/// Σ m v/Σ m (C.25). Along each axis a body takes part with its mass there, unless the host locks the axis.
class ZoneVelocity {
 public:
  void add(double inverse_mass, const Vec3& velocity) {
    mass_.array() += 1 / inverse_mass;
    momentum_ += velocity / inverse_mass;
  }
  void add(const BodyMotion& body) {
    for (int k = 0; k < 3; ++k) {
      if (!(body.inverse_mass[k] > 0)) continue;
      mass_[k] += 1 / body.inverse_mass[k];
      momentum_[k] += body.velocity[k] / body.inverse_mass[k];
    }
  }
  Vec3 value() const { return (mass_.array() > 0).select(momentum_.cwiseQuotient(mass_), Vec3::Zero()); }

  /// Gives it to a body by an impulse at the centre of mass, along its free axes.
  void give(BodyMotion& body, ContactReport& report) const {
    Vec3 impulse = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (body.inverse_mass[k] > 0) impulse[k] = (value()[k] - body.velocity[k]) / body.inverse_mass[k];
    push_body(body, Vec3::Zero(), impulse);
    report.impulse_on_bodies += impulse;
  }

 private:
  Vec3 mass_ = Vec3::Zero(), momentum_ = Vec3::Zero();
};

}  // namespace oilskin::contact
