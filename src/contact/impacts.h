/// Violations become contact constraints at their times of impact (docs/theory/contact.md, "Impacts").
#pragma once

#include "contact/constraints.h"
#include "contact/detection.h"

namespace oilskin::contact {

struct ImpactGeometry {
  std::array<double, 3> weights{};  ///< b_c of the closest point
  Vec3 normal = Vec3::Zero();       ///< from the triangle to the particle
  double start_distance = 0;        ///< d0 [m]
};

/// Geometry close to the time of impact `time` of the motion x0 → x1. Where rounding dominates the distance,
/// an earlier time is used, down to the start (C.21); there it is well defined, since d0 ≥ δ.
ImpactGeometry impact_geometry(const PointTriangle& x0, const PointTriangle& x1, double time, double delta);

/// One constraint per violation, in order. The earliest impact of a particle also moves its end next to the
/// impact point (C.22). The gap is halved in each iteration, counted from 0 and down to 2 δ, so that
/// particles fit between layers closer than h.
std::vector<ContactConstraint> impact_constraints(Context& context, const std::vector<Violation>& violations,
                                                  int iteration);

}  // namespace oilskin::contact
