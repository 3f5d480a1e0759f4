/// The drag of a plane wall on a particle of a viscous liquid (V.4).
#pragma once

#include <vector>

#include "fluid/lattice.h"

namespace oilskin::effects {

/// ψ(q) of (F.10).
double viscous_shape(const fluid::ViscousWeights& weights, double q);

/// S(ζ) of (V.5), tabulated for one ratio H/dx.
class WallDrag {
 public:
  explicit WallDrag(double ratio);

  double ratio() const { return ratio_; }
  /// ζ: distance from the wall over H; 0 for ζ ≥ 1.
  double operator()(double zeta) const;

 private:
  double ratio_;
  std::vector<double> table_;
};

}  // namespace oilskin::effects
