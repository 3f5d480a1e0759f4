/// @file
/// The effect "wetting": cloth takes up liquid, which spreads in it, weighs it down, drips from it and dries.
#pragma once

#include <memory>

#include "oilskin/effect.h"

namespace oilskin {

/// What a textile takes up, and how liquid spreads in it. Saturation S is the liquid at a place over the
/// capacity there.
struct Fabric {
  /// C [kg/m²], 1e-6 … 1e3: liquid at S = 1 per area of the rest shape; density × porosity × thickness.
  double capacity = 0.3;
  /// D₀ [m²/s], 1e-15 … 1: capillary diffusivity at S = 1, mean of warp and weft.
  double diffusivity = 1e-5;
  /// a, 0 … 10: the mobility is Sᵃ. 0: linear diffusion; 1 … 3: a wet region with a sharp front.
  double mobility_exponent = 2;
  /// ℓ_c [m], 1e-6 … infinity: how high liquid rises at 9.81 m/s². Infinity: gravity moves nothing.
  double capillary_rise = 0.1;
  /// Diffusivity along the warp over that along the weft, 1e-3 … 1e3.
  double anisotropy = 1;
  /// Direction of the warp in the rest shape; any length > 0. Triangles across it are isotropic.
  Vec3 warp = Vec3::UnitX();
  /// S up to which contact and gravity fill a place, 1 … 10. What exceeds S = 1 is a film in and under the
  /// fabric, which drips: above 1 water seeps through soaked cloth.
  double saturation_limit = 1.5;

  /// Refuses numbers out of range.
  Status validate() const;
};

/// Capacities follow from mass per area, thickness and the density of the fibre (1540, 1310, 1140 kg/m³). The
/// rest are guesses with the magnitude of strips that wick some centimetres in minutes: fabrics of one fibre
/// differ by more than fibres do [Crow1993]. docs/theory/effects_wetting.md shows how to measure D₀ and ℓ_c.
/// Bleached sheeting: 0.15 kg/m², 0.4 mm.
Fabric cotton_fabric();
/// Washed, not water-repellent: 0.25 kg/m², 0.8 mm; wets slowly.
Fabric wool_fabric();
/// Filament, not coated: 0.1 kg/m², 0.2 mm.
Fabric nylon_fabric();

/// Settings of Wetting.
struct WettingSettings {
  /// Of all cloth without one of its own.
  Fabric fabric;
  /// k_a [kg/(m² s)], 0 … 1e6: uptake of dry cloth under water; dry cloth is soaked within about
  /// capacity/k_a.
  double absorption = 1;
  /// [1/s], 0 … 1e6: what exceeds S = 1 gathers to drops at this rate.
  double dripping = 5;
  /// [1/s], 0 … 1e6: part of the liquid that dries per time; less where water covers one side or both.
  double drying = 0;
  /// [s], 0 … 1: liquid spreads in steps of at least this length, since it is slower than cloth moves by
  /// orders of magnitude. 0: in every interval.
  double transport_interval = 0.004;

  /// Refuses numbers out of range.
  Status validate() const;
};

/// Liquid passes from particles to the cloth that they touch (W.16), spreads in it (W.3), and
/// leaves it as particles where there is more than it can hold (W.18). Mass and momentum are kept: of water
/// and cloth together, and in the ledgers of StepReport. Surfaces with a node that is free absorb, others do
/// not, unless they have a fabric of their own. The rest shape is that in which a surface is first seen.
class Wetting : public Effect {
 public:
  /// Settings that validate() refuses make status() a refusal; World::add_effect() then refuses it.
  explicit Wetting(const WettingSettings& settings = {});
  ~Wetting() override;

  /// Whether the settings were accepted.
  Status status() const override;
  /// The settings.
  const WettingSettings& settings() const;
  /// The fabric of one surface, from the next step on. Refuses numbers out of range. It is saved under the
  /// number of `id`: a world that restores it must have given its surfaces the same numbers.
  Status set_fabric(SurfaceId id, const Fabric& fabric);
  /// A surface that absorbs nothing more, such as waterproof cloth. What it holds stays.
  void set_waterproof(SurfaceId id);
  /// C A_i of each node of a surface in the last step [kg]; empty before its first one, and where nothing is
  /// absorbed.
  Span<const double> capacity(SurfaceId id) const;

  std::string name() const override { return "wetting"; }
  std::vector<double> node_values() const override;
  double wall_reach() const override { return 0.9; }
  bool changes_masses() const override { return true; }
  void act(EffectForces& f) override;
  void exchange(EffectExchange& e) override;
  void checkpoint() override;
  void roll_back() noexcept override;
  std::vector<std::uint8_t> save() const override;
  Status restore(Span<const std::uint8_t> saved) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin
