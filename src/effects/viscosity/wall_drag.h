/// The drag of a plane wall on a particle of a viscous liquid (V.4).
#pragma once

#include <vector>

#include "fluid/lattice.h"

namespace oilskin::effects {

/// ψ(q) of (F.10).
double viscous_shape(const fluid::ViscousWeights& weights, double q);

/// S(ζ) of (V.5) along the wall and across it, tabulated for one ratio H/dx.
class WallDrag {
 public:
  struct Share {
    double along = 0, across = 0;
  };

  explicit WallDrag(double ratio);

  double ratio() const { return ratio_; }
  /// ζ: distance from the wall over H; 0 for ζ ≥ 1.
  Share operator()(double zeta) const;

 private:
  double ratio_;
  std::vector<Share> table_;
};

}  // namespace oilskin::effects
