/// Continuous test of a moving point against a moving triangle. Stands alone: knows nothing of particles or
/// cloth.
#pragma once

#include "oilskin/types.h"

namespace oilskin::ccd {

struct PointTriangleMotion {
  Vec3 p_t0, a_t0, b_t0, c_t0;  ///< point and corners at t = 0
  Vec3 p_t1, a_t1, b_t1, c_t1;  ///< and at t = 1; all move linearly
};

struct Impact {
  bool hit = false;
  double time = 1;  ///< of impact, in [0, 1]; never later than the true first touch (hit only)
};

/// Do the closed paths touch for some t in [0, 1]? Exact for any finite input: points that do not move and
/// touch are an impact at 0. Input that is not finite is an impact at 0 unless an axis separates it.
///
/// A filter of double arithmetic with error bounds decides most queries (tens of nanoseconds to a
/// microsecond), exact arithmetic the others (2 to 10 µs for coordinates of similar size). Deterministic,
/// without allocation.
Impact point_triangle(const PointTriangleMotion& m);

}  // namespace oilskin::ccd
