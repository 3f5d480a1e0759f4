/// What a run adds up from the reports of its steps.
#pragma once

#include "oilskin/world.h"

namespace oilskin::demo {

struct Totals {
  std::uint64_t steps = 0, substeps = 0;
  double simulated = 0;  ///< [s]
  StageSeconds seconds;
  ContactReport contact;
  std::uint64_t emitted = 0, removed = 0, removed_by_sinks = 0, removed_by_age = 0, removed_invalid = 0,
                blocked_starts = 0;
  std::uint64_t limited_starts = 0;           ///< by WorldSettings::max_particles
  std::uint64_t absorbed = 0, released = 0;   ///< particles, by cloth
  double mass_emitted = 0, mass_removed = 0;  ///< [kg]
  double mass_absorbed = 0, mass_released = 0, mass_dried = 0, mass_lost = 0;  ///< [kg]
  double density_error_sum = 0, density_error_max = 0;
  std::uint64_t pressure_iterations = 0;
  Vec3 momentum_emitted = Vec3::Zero(), momentum_removed = Vec3::Zero(), momentum_gravity = Vec3::Zero();
  Vec3 momentum_residual = Vec3::Zero();
  double momentum_scale = 0;           ///< Σ of the lengths of all that was exchanged [N s]
  EnergyReport energy;                 ///< of the last step
  double max_made = 0, max_risen = 0;  ///< of all steps, see EnergyReport [J]
  double max_made_fraction = 0, max_risen_fraction = 0;  ///< over the scale of the same step
  std::uint64_t removed_too_fast = 0;
  std::uint64_t diverged_steps = 0;  ///< with flag_pressure_diverged
  std::uint32_t flags = 0;
  std::vector<std::string> messages;  ///< each once
  std::string energy_message;         ///< of the step in which most energy had been made

  void add(const StepReport& report);
  /// What the ledger leaves in the fluid [kg].
  double mass_in_fluid() const { return mass_emitted - mass_removed - mass_absorbed + mass_released; }
  /// What it leaves in the cloth [kg].
  double mass_in_cloth() const { return mass_absorbed - mass_released - mass_dried - mass_lost; }
};

/// Momentum of the fluid now [N s], summed over the particles.
Vec3 fluid_momentum(const World& world);

}  // namespace oilskin::demo
