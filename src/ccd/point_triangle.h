/// Continuous test of a moving point against a moving triangle (docs/theory/continuous_test.md). Independent
/// of particles and cloth.
#pragma once

#include "oilskin/types.h"

namespace oilskin::ccd {

/// A point p and the corners a, b, c of a triangle at t = 0 and t = 1. All move linearly.
struct PointTriangleMotion {
  Vec3 p_t0, a_t0, b_t0, c_t0;
  Vec3 p_t1, a_t1, b_t1, c_t1;
};

struct Impact {
  bool hit = false;
  /// Time of impact in [0, 1], not later than the true first touch. 1 without a hit.
  double time = 1;
};

/// Do the closed paths touch for some t in [0, 1]? Exact for any finite input: points that do not move and
/// touch are an impact at 0. Input that is not finite is an impact at 0 unless an axis separates it.
///
/// A filter of double arithmetic with error bounds decides most queries (tens of nanoseconds to a
/// microsecond), exact arithmetic the others (2 to 10 µs for coordinates of similar size). Deterministic,
/// without allocation.
Impact point_triangle(const PointTriangleMotion& m);

}  // namespace oilskin::ccd
