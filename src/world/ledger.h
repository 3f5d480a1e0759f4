/// Mass and momentum that particles bring into a step and take out of it.
#pragma once

#include "oilskin/report.h"

namespace oilskin::world {

class Ledger {
 public:
  /// Adds to `report`; a new particle weighs particle_mass [kg]. `ratio` is the mass of a particle over that.
  Ledger(StepReport& report, double particle_mass) : report_(report), mass_(particle_mass) {}

  /// Particles that are in the fluid when the step begins: Σ ratio × velocity.
  void present_before(const Vec3& sum) { report_.momentum_before += mass_ * sum; }
  /// One of them.
  void present_before(double ratio, const Vec3& velocity) {
    report_.momentum_before += ratio * mass_ * velocity;
  }
  void emitted(const Vec3& velocity) {
    ++report_.emitted;
    report_.momentum_emitted += mass_ * velocity;
  }
  /// Of the particles of an interval at once, so that the sum has one rounding.
  void emitted_mass(std::size_t count) { report_.mass_emitted += static_cast<double>(count) * mass_; }
  /// Gravity acts for dt [s] on particles whose ratios add up to `sum`.
  void gravity(double sum, double dt, const Vec3& gravity) {
    report_.momentum_gravity += sum * mass_ * dt * gravity;
  }
  /// Effects accelerate a particle for dt [s].
  void effect(double ratio, double dt, const Vec3& acceleration) {
    report_.momentum_effects += ratio * mass_ * dt * acceleration;
  }
  /// What effects give a surface [N s].
  void effect(const Vec3& impulse) { report_.momentum_effects += impulse; }
  /// A particle that leaves the fluid; the caller counts the reason.
  void removed(double ratio, const Vec3& velocity) {
    report_.mass_removed += ratio * mass_;
    report_.momentum_removed += ratio * mass_ * velocity;
  }
  /// What the caller removed since the last step, when the fluid still had its momentum: Σ ratio and
  /// Σ ratio × velocity.
  void withdrawn(double ratio, const Vec3& momentum) {
    report_.mass_removed += ratio * mass_;
    report_.momentum_removed += mass_ * momentum;
    report_.momentum_before += mass_ * momentum;
  }
  /// A particle whose numbers are out of range: its momentum is not counted.
  void removed_without_momentum(double ratio) { report_.mass_removed += ratio * mass_; }
  /// A surface absorbs the part `ratio` of a new particle's mass.
  void absorbed(double ratio, const Vec3& velocity) {
    report_.mass_absorbed += ratio * mass_;
    report_.momentum_absorbed += ratio * mass_ * velocity;
  }
  /// A surface releases a particle.
  void released(const Vec3& velocity) {
    ++report_.released;
    report_.mass_released += mass_;
    report_.momentum_released += mass_ * velocity;
    present_after(1, velocity);
  }

  /// Of some of the particles at the end of an interval: threads add up their own.
  struct Sums {
    Vec3 after = Vec3::Zero();  // of those that stay, Σ ratio × velocity
    double removed = 0;         // Σ ratio of those that leave
    Vec3 removed_momentum = Vec3::Zero();

    void stays(double ratio, const Vec3& velocity) { after += ratio * velocity; }
    void leaves(double ratio, const Vec3& velocity) {
      removed += ratio;
      removed_momentum += ratio * velocity;
    }
    void operator+=(const Sums& o) {
      after += o.after;
      removed += o.removed;
      removed_momentum += o.removed_momentum;
    }
  };
  /// All particles at the end of an interval.
  void end_interval(const Sums& sums) {
    report_.momentum_after = mass_ * sums.after;
    report_.mass_removed += sums.removed * mass_;
    report_.momentum_removed += mass_ * sums.removed_momentum;
  }
  void present_after(double ratio, const Vec3& velocity) {
    report_.momentum_after += ratio * mass_ * velocity;
  }

 private:
  StepReport& report_;
  double mass_;
};

}  // namespace oilskin::world
