/// The shape of an inextensible strip that holds water, in two dimensions.
#pragma once

#include <vector>

#include "study/cases/shapes.h"

namespace oilskin::demo {

/// Lengths over that of the strip, L; forces per unit of width over ρ g L².
struct Trough {
  double gap = 0.7;    ///< B/L between the rims, which are level: 0.3 … 0.95
  double area = 0.15;  ///< A/L² of the water's cross-section, 0 … what the trough holds
  double weight = 0;   ///< of the strip over that of a water layer of the thickness L: w/(ρ g L), ≥ 0
};

struct TroughShape {
  double depth = 0;            ///< of the water over the lowest point; with area 0: 0
  double sag = 0;              ///< of the lowest point below the rims
  double end_angle = 0;        ///< of the strip at the rims, above the horizontal [rad]
  double pull = 0;             ///< horizontal, of a rim
  std::vector<Point2> points;  ///< from rim to rim at equal lengths of the strip; lowest point at (0, 0)
};

/// Equilibrium: (T dθ/ds) = ρ g (d − y)₊ + w cos θ and dT/ds = w sin θ, with the angle θ, the tension T, the
/// length s from the lowest point, the height y over it and the water's depth d. T at s = 0 and d are found
/// by bisection from the distance of the rims and the area. `points` has 2 `segments` + 1 entries.
TroughShape trough_shape(const Trough& trough, int segments);

}  // namespace oilskin::demo
