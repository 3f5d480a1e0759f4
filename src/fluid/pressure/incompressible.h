/// What PCISPH and DFSPH have in common: the calibration, the sums at the start of a step, and the target of
/// the density.
///
/// Pressures are stored as φ = p dt² (V/V_s) D/(ρ0 H²) (F.15), without dimension, so that a pair moves
/// particle i by −(φ_i + φ_j) w'/q Δ in units of H within the step (F.16).
#pragma once

#include "fluid/lattice.h"
#include "fluid/pressure/pair_sums.h"
#include "oilskin/settings.h"

namespace oilskin::fluid {

/// What a loop that has not converged may add to |displacement|² [H²], per particle (F.83): for the water as
/// a whole u² dt/t_r, u a tenth of a spacing within t_r; for particles that overlap what separates them.
struct CorrectionEnergy {
  double of_all = 0, of_overlap = 0;

  double of(double relative_density) const;
};

/// Constants of an incompressible fluid, from its settings.
struct IncompressibleFluid {
  explicit IncompressibleFluid(const FluidSettings& settings);

  FluidSettings settings;
  double support_radius;  // H [m]
  double volume;          // V [m³]: of a particle on the lattice at rest density; the sums use it
  double settled_volume;  // V_s [m³]: of a particle in settled water; its mass follows from it (F.6)
  ViscousWeights viscous_weights;
  float density_scale;    // D
  float self_density;     // D w(0)
  double stiffness;       // τ: change of φ per relative density error (F.17)
  double max_relaxation;  // ω (F.22)
  double virial;          // pressure of settled water over φ of (F.15)
  float wall_scale;       // 1/D: displacement by a wall in units of H per φ γ (F.16)

  /// Density, viscosity and XSPH of a step. Viscosity (F.10), a_i = −2 ν/H² Σ ψ(q) (v_ij·Δ) Δ: the term of
  /// [Monaghan2005] with a second part that makes it isotropic on the lattice. Conserves angular momentum,
  /// too.
  ExplicitModel explicit_model(double dt) const;
  double phi_per_pascal(double dt) const;
  /// φ at the start per pressure of the last step [1/Pa] (F.25).
  double warm_start(const StepState& state) const;
  /// η of the stop rule (F.19): at most `settings.tolerance`.
  double error_per_step(const StepState& state) const;
  CorrectionEnergy energy_of_correction(const StepState& state) const;
};

/// ē_i (F.18): the density errors that the step aims at, 0 except for over-compressed
/// particles.
void set_targets(const StepState& state, const FluidSettings& settings, std::vector<float>& target);

}  // namespace oilskin::fluid
