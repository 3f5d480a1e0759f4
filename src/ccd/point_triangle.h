/// Continuous test of a moving point against a moving triangle. Stands alone: knows nothing of particles or
/// cloth.
#pragma once

#include "oilskin/types.h"

namespace oilskin::ccd {

struct PointTriangleMotion {
  Vec3 p_t0, a_t0, b_t0, c_t0;  ///< point and corners at t = 0
  Vec3 p_t1, a_t1, b_t1, c_t1;  ///< and at t = 1; all move linearly
};

struct Meeting {
  bool hit = false;
  double time = 1;  ///< of impact, in [0, 1]; never later than the true first touch (hit only)
};

/// false = the closed paths are certainly disjoint for all t in [0, 1] (touching is a hit). true may be a
/// false positive where rounding cannot decide. Four bit-equal end points (nothing moves) return false before
/// anything else: the zones of contact rest on it (docs/architecture.md). Finite input of magnitude < 1e90.
Meeting point_triangle(const PointTriangleMotion& m);

}  // namespace oilskin::ccd
