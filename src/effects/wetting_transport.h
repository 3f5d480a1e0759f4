/// Transport of absorbed liquid in a wet textile: capillarity and gravity on a triangle mesh.
#pragma once

#include <memory>
#include <vector>

#include "effects/flux_limiter.h"
#include "effects/wetting_flow.h"
#include "effects/wetting_mesh.h"
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

/// Guesses: none of these numbers is measured. They have the magnitude of capacities computed from mass,
/// thickness and density of fibres, and of strips that wick some centimetres in minutes. Fabrics of one
/// fibre differ by more than fibres do [Crow1993]: measure D₀ and ℓ_c on a strip,
/// docs/theory/effects_wetting.md. Bleached sheeting: 0.15 kg/m², 0.4 mm.
Fabric cotton_fabric();
/// Washed, not water-repellent: 0.25 kg/m², 0.8 mm; wets slowly.
Fabric wool_fabric();
/// Filament, not coated: 0.1 kg/m², 0.2 mm.
Fabric nylon_fabric();

struct TransportReport {
  /// What the held nodes gave to the textile [kg]; < 0: took.
  double supplied = 0;
  /// Of the iterative solver; 0 where all is dry or it fell back to the direct method.
  int iterations = 0;
};

/// Liquid spreads in a mesh, (W.3). One thread; same input, same bits.
class WettingTransport {
 public:
  /// Whether the constructor accepts this: finite positions below 1e15 m, indices of existing nodes.
  static Status validate(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric);

  /// The input must be valid (asserted). Degenerate and duplicate triangles are left out.
  WettingTransport(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric);
  WettingTransport(const WettingTransport&) = delete;
  WettingTransport& operator=(const WettingTransport&) = delete;

  /// C A_i per node [kg]; 0 for a node of no triangle with an area: its liquid stays.
  const std::vector<double>& capacity() const { return mesh_.capacity; }

  /// Moves liquid for `dt` ≥ 0 [s]. The sum of `liquid` [kg per node, ≥ 0] changes by the rounding of one
  /// value only, in each connected part; S stays between 0 and the largest of saturation_limit and what was
  /// there. `position`: current [m]; `gravity` [m/s²]: what liquid at rest in the textile feels, g less the
  /// acceleration of the textile. `held`: nodes whose liquid does not change, as in a reservoir. Refuses
  /// arrays of other sizes than the mesh and values that are not finite or out of range, and changes nothing.
  Status step(double dt, Span<const Vec3> position, const Vec3& gravity, Span<double> liquid,
              Span<const std::uint32_t> held = {}, TransportReport* report = nullptr);

 private:
  static const Fabric& checked(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric);
  Status check(double dt, Span<const Vec3> position, const Vec3& gravity, Span<const double> liquid,
               Span<const std::uint32_t> held) const;
  void prepare(Span<const double> liquid, Span<const std::uint32_t> held);
  void find_upper();
  void add_amounts(const std::vector<double>& amount, std::vector<double>& mass) const;
  void correct_flux(std::vector<double>& mass);
  void bound(Span<const Vec3> position, const Vec3& slope, std::vector<double>& mass) const;

  Fabric fabric_;
  WettingMesh mesh_;
  WettingFlow flow_;
  PartSums sums_;
  std::vector<double> saturation_, upper_;
  std::vector<std::uint8_t> held_;
};

}  // namespace oilskin
