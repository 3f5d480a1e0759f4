/// Transport of absorbed liquid in a wet textile: capillarity and gravity on a triangle mesh.
#pragma once

#include <vector>

#include "effects/wetting/flux_limiter.h"
#include "effects/wetting/wetting_flow.h"
#include "effects/wetting/wetting_mesh.h"
#include "oilskin/types.h"
#include "oilskin/wetting.h"

namespace oilskin {

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
