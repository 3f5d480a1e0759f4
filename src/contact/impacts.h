/// Bad pairs become rows: normal and weights at the time of impact, landing where they struck.
#pragma once

#include "contact/constraints.h"
#include "contact/detection.h"

namespace oilskin::contact {

/// A direction from the triangle to the particle near the moment `time` of the motion x0 → x1, with the
/// closest point's weights. Well defined because the particle starts at d0 ≥ δ (C.21): where rounding swamps
/// the distance, an earlier moment is taken, down to the start.
struct ImpactGeometry {
  std::array<double, 3> weights{};
  Vec3 normal = Vec3::Zero();
  double start_distance = 0;  ///< d0 [m]
};
ImpactGeometry impact_geometry(const PointTriangle& x0, const PointTriangle& x1, double time, double delta);

/// One row for each bad pair, in order; the earliest meeting of a particle also moves its end to the landing
/// point (C.22): where it struck, at gap h (never below 2 δ). `round` counts from 0: later landings come
/// closer, so that a particle between two layers nearer than h finds a place.
std::vector<ContactConstraint> impact_constraints(Context& context, const std::vector<Violation>& violations,
                                                  int round);

}  // namespace oilskin::contact
