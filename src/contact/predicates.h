/// The two predicates of the promise: pure functions of stored numbers (docs/theory/contact.md,
/// "Predicates").
#pragma once

#include "ccd/point_triangle.h"
#include "core/closest_point.h"
#include "core/ieee.h"
#include "oilskin/types.h"

namespace oilskin::contact {

/// A particle and the corners of a triangle at one time.
struct PointTriangle {
  Vec3 p, a, b, c;
};

struct EndDistance {
  bool too_close = false;  ///< closer than δ, or not certainly at least δ away
  double distance = 0;     ///< as computed [m]
};

/// Squared distance of the point from the triangle's box, a lower bound of the squared distance [m²].
inline double squared_distance_to_box(const PointTriangle& q) {
  const Vec3 low = q.a.cwiseMin(q.b).cwiseMin(q.c), high = q.a.cwiseMax(q.b).cwiseMax(q.c);
  return (low - q.p).cwiseMax(q.p - high).cwiseMax(0.0).squaredNorm();
}

/// A particle farther than this from the triangle's box is not too close [m].
inline double too_close_cutoff(double delta) {
  return 1.0001 * delta;
}

/// too_close is false only if the true distance is at least δ: by the triangle's box (too_close_cutoff()), or
/// by a separating direction with bounded dot products (C.23). The direction comes from the closest point,
/// whose accuracy does not matter.
EndDistance end_distance(const PointTriangle& q, double delta);

/// False only if the paths x0 → x1 are certainly disjoint (ccd/point_triangle.h), or if x1 = x0 bit for bit:
/// a held pair counts as disjoint, since it was no violation at the end of the last interval (Lemma 1 of
/// docs/theory/contact.md).
ccd::Impact paths_intersect(const PointTriangle& x0, const PointTriangle& x1);

/// x0 + t (x1 − x0), rounded: for directions, not for predicates.
PointTriangle interpolate(const PointTriangle& x0, const PointTriangle& x1, double t);

}  // namespace oilskin::contact
