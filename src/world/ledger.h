/// Mass and momentum that particles bring into a step and take out of it.
#pragma once

#include "oilskin/report.h"

namespace oilskin::world {

class Ledger {
 public:
  /// Adds to `report`; each particle weighs particle_mass [kg].
  Ledger(StepReport& report, double particle_mass) : report_(report), mass_(particle_mass) {}

  /// A particle that is in the fluid when the step begins.
  void present_before(const Vec3& velocity) { report_.momentum_before += mass_ * velocity; }
  void emitted(const Vec3& velocity) {
    ++report_.emitted;
    report_.momentum_emitted += mass_ * velocity;
  }
  /// Of the particles of an interval at once, so that the sum has one rounding.
  void emitted_mass(std::size_t count) { report_.mass_emitted += static_cast<double>(count) * mass_; }
  /// Gravity acts on `count` particles for dt [s].
  void gravity(std::size_t count, double dt, const Vec3& gravity) {
    report_.momentum_gravity += static_cast<double>(count) * mass_ * dt * gravity;
  }
  /// Effects accelerate a particle for dt [s].
  void effect(double dt, const Vec3& acceleration) { report_.momentum_effects += mass_ * dt * acceleration; }
  /// What effects give a surface [N s].
  void effect(const Vec3& impulse) { report_.momentum_effects += impulse; }
  /// A particle that leaves the fluid; the caller counts the reason.
  void removed(const Vec3& velocity) {
    report_.mass_removed += mass_;
    report_.momentum_removed += mass_ * velocity;
  }
  /// A particle whose numbers are out of range: its momentum is not counted.
  void removed_without_momentum() { report_.mass_removed += mass_; }

  /// The sum of present_after() begins again: the fluid at the end of an interval.
  void begin_after() { report_.momentum_after.setZero(); }
  void present_after(const Vec3& velocity) { report_.momentum_after += mass_ * velocity; }

 private:
  StepReport& report_;
  double mass_;
};

}  // namespace oilskin::world
