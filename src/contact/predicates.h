/// The two predicates that the promise is made of. Pure functions of stored numbers: same bits, same answer.
#pragma once

#include "ccd/point_triangle.h"
#include "core/closest_point.h"
#include "core/ieee.h"
#include "oilskin/types.h"

namespace oilskin::contact {

/// Four points at one moment.
struct PointTriangle {
  Vec3 p, a, b, c;
};

struct EndDistance {
  bool too_close = false;  ///< nearer than δ, or rounding cannot tell
  double distance = 0;     ///< computed [m]
};

/// Squared distance of the point from the box of the triangle: a lower bound of their distance, squared.
inline double squared_distance_to_box(const PointTriangle& q) {
  const Vec3 low = q.a.cwiseMin(q.b).cwiseMin(q.c), high = q.a.cwiseMax(q.b).cwiseMax(q.c);
  return (low - q.p).cwiseMax(q.p - high).cwiseMax(0.0).squaredNorm();
}

/// Beyond this distance from the triangle's box nothing is near [m].
inline double too_close_cutoff(double delta) {
  return 1.0001 * delta;
}

/// near(p, T, x). Not near = the true distance is ≥ δ: by the triangle's box (`too_close_cutoff`), or
/// certified by a separating direction whose three dot products are bounded, whatever the quality of the
/// closest point that suggested it. A sliver whose closest point is all rounding is therefore near only where
/// its box is.
EndDistance end_distance(const PointTriangle& q, double delta);

/// False only if the paths x0 → x1 are certainly disjoint (ccd/point_triangle.h), or if x1 = x0 bit for bit:
/// a held pair counts as disjoint, since it was no violation at the end of the last interval (Lemma 1 of
/// docs/theory/contact.md).
ccd::Impact paths_intersect(const PointTriangle& x0, const PointTriangle& x1);

/// x0 + t (x1 − x0), for choosing directions only, never for deciding.
PointTriangle interpolate(const PointTriangle& x0, const PointTriangle& x1, double t);

}  // namespace oilskin::contact
