/// @file
/// Implicit viscosity: thick liquids such as honey at any step.
#pragma once

#include <limits>
#include <memory>

#include "oilskin/effect.h"

namespace oilskin {

/// What a thick liquid is like, and how exactly its viscosity is solved.
struct ImplicitViscositySettings {
  /// Kinematic viscosity ν [m²/s], > 0, to 1e6. Water has 1e-6, oil 1e-4, honey 0.005 to 0.05.
  double coefficient = 0.01;
  /// Of the solution: the largest norm of the residual over that of the velocities against each other and
  /// against walls (V.8), 1e-12 … 0.1. Momentum is exact whatever it is.
  double tolerance = 1e-4;
  /// Of the conjugate gradients, 1 … 10000. Where they do not suffice, less viscosity acts (V.9).
  int max_iterations = 500;

  /// Refuses what is out of range, with a message that names the field.
  Status validate() const;
};

/// How the last interval was solved.
struct ImplicitViscosityReport {
  /// Iterations of the conjugate gradients.
  int iterations = 0;
  /// Norm of the residual over that of velocities: `tolerance` or less where it converged.
  double residual = 0;
  /// Whether `tolerance` was reached within `max_iterations`, or as far as rounding allows.
  bool converged = true;
  /// The part of the computed forces that acts, 0 … 1 (V.9). Below 1 − tolerance only where it did not
  /// converge.
  double applied = 1;
};

/// Viscosity, integrated implicitly: (V.1) to (V.11) of docs/theory/effects_viscosity.md. The pair term is
/// that of FluidSettings::viscosity (F.10), after [Monaghan2005], solved with conjugate gradients as in
/// [Weiler2018]. Stable at any step. It never makes energy, whether it converged or not. Pair forces conserve
/// linear and angular momentum up to rounding.
///
/// Surfaces with SlipModel::viscous_wall or SlipModel::sticking drag the liquid, and get the reaction; with
/// others it slips freely as far as this effect goes. FluidSettings::viscosity acts in addition; it can be 0.
/// Effects that push the fluid should be added before this one, which then sees their forces.
class ImplicitViscosity : public Effect {
 public:
  /// Settings that validate() refuses make status() a refusal; World::add_effect() then refuses it.
  explicit ImplicitViscosity(const ImplicitViscositySettings& settings = {});
  ~ImplicitViscosity() override;

  /// Whether the settings were accepted.
  Status status() const override { return status_; }
  /// The settings in use.
  const ImplicitViscositySettings& settings() const { return settings_; }
  /// Takes other settings from the next interval on, or refuses and changes nothing.
  Status set_settings(const ImplicitViscositySettings& settings);
  /// Of the last interval.
  const ImplicitViscosityReport& report() const { return report_; }

  std::string name() const override { return "viscosity"; }
  /// The acceleration by drag in the last interval [m/s²], where the next solution starts; the velocity that
  /// it would have left without pressure [m/s]; what pressure is expected to do [m/s²] (V.12); its length
  /// [s].
  std::vector<double> particle_values() const override;
  /// What the surface's host holds of the drag (V.10), (V.13).
  std::vector<double> node_values() const override;
  double wall_reach() const override { return std::numeric_limits<double>::infinity(); }
  bool is_friction() const override { return true; }
  void act(EffectForces& forces) override;
  /// The settings.
  std::vector<std::uint8_t> save() const override;
  Status restore(Span<const std::uint8_t> saved) override;

 private:
  struct Workspace;

  ImplicitViscositySettings settings_;
  Status status_;
  ImplicitViscosityReport report_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace oilskin
