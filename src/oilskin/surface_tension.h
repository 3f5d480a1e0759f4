/// @file
/// An effect: the surface tension of the fluid, and how far it wets surfaces.
#pragma once

#include <limits>

#include "oilskin/effect.h"

namespace oilskin {

/// Settings of SurfaceTension.
struct SurfaceTensionSettings {
  /// The surface tension σ [N/m], > 0, finite. Water has 0.0728 at 20 °C.
  double coefficient = 0.0728;
  /// The contact angle θ at surfaces, measured in the fluid [degrees], 0 … 180: 0 wets, 180 does not adhere.
  double contact_angle = 90;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

/// Surface tension and adhesion by forces between particles, and between particles and the parts of surfaces
/// that they see. Nothing acts through a surface.
///
/// The forces are the slope of two energies of the fluid's border (S.3). A surface counts as a part of the
/// fluid that it would be, were it fluid, and attracts; both follow from the contact angle (S.7). Angles
/// below 60° come out too small. Forces on particles and surfaces add up to zero. Made for H = 2 dx; what was
/// measured: docs/decisions/0025-surface-tension.md.
class SurfaceTension : public Effect {
 public:
  /// Settings that are out of range act like none; World::add_effect() refuses them.
  explicit SurfaceTension(const SurfaceTensionSettings& settings = {});

  /// Accepted, or what is wrong with the settings given at construction.
  Status status() const override { return status_; }
  /// What acts.
  const SurfaceTensionSettings& settings() const { return settings_; }
  /// Changes what acts, between steps. A refusal changes nothing.
  Status set_settings(const SurfaceTensionSettings& settings);

  std::string name() const override { return "surface_tension"; }
  double wall_reach() const override { return std::numeric_limits<double>::infinity(); }
  void act(EffectForces& f) override;
  /// What the shortest capillary waves allow (S.9) [s].
  double longest_interval(const FluidSettings& fluid) const override;

  std::vector<std::uint8_t> save() const override;
  Status restore(Span<const std::uint8_t> saved) override;

 private:
  void find_border(const EffectForces& f, std::size_t i);
  Vec3 pair_acceleration(const EffectForces& f, std::size_t i) const;
  Vec3 plane_force(const EffectForces& f, std::size_t i, double share, double distance,
                   const Vec3& normal) const;
  void act_with_walls(EffectForces& f) const;

  SurfaceTensionSettings settings_;
  Status status_;
  // Of the interval
  double strength_ = 0;         // c_σ σ, σ being what is stable [N/m]
  double wall_attraction_ = 0;  // κ_w (S.7)
  double wall_as_fluid_ = 0;    // k (S.7)
  std::vector<double> lack_;    // d_i (S.1)
  std::vector<Vec3> slope_;     // g_i (S.2), in units of 1/H
};

}  // namespace oilskin
