/// What a textile takes up, and how liquid spreads in it.
#pragma once

#include "oilskin/types.h"

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
  /// S up to which gravity fills a place, 1 … 10. Above 1: a film that may drip.
  double saturation_limit = 1;

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

}  // namespace oilskin
