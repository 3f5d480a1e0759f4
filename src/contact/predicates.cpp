#include "contact/predicates.h"

#include <cmath>
#include <cstring>

#include "core/assert.h"

namespace oilskin::contact {

namespace {

// (C.23). Lower bound of n·(p − corner), in units of |n|. With u = 2⁻⁵³: one rounding in the difference, one
// in the product, two in the sums, four in the length of n give 8 u Σ|n_k (p − corner)_k|; 12 u leaves a
// margin.
double lower_bound(const Vec3& n, const Vec3& p, const Vec3& corner) {
  constexpr double u = 0x1p-53;
  double sum = 0, magnitude = 0;
  for (int k = 0; k < 3; ++k) {
    const double product = n[k] * (p[k] - corner[k]);
    sum += product;
    magnitude += std::abs(product);
  }
  return sum - 12 * u * magnitude;
}

// Is the true distance certainly ≥ δ?
bool certainly_far(const PointTriangle& q, const ClosestPoint& c, double delta) {
  if (!(c.distance >= delta)) return false;
  // The smallest of the three projections is a lower bound of the distance for any unit vector n, and equal
  // to it for the exact one.
  const Vec3 n = c.offset / c.distance;
  OILSKIN_ASSERT(std::isfinite(c.distance));
  const double bound =
      std::min({lower_bound(n, q.p, q.a), lower_bound(n, q.p, q.b), lower_bound(n, q.p, q.c)}) *
      (1 - 0x1p-50);
  return bound >= delta;
}

// Must depend on the four points and δ only: a pair held at x0 is good because the same bits were good at the
// end of the last interval, where it may not have been a candidate.
bool box_is_close(const PointTriangle& q, double delta) {
  const double reach = too_close_cutoff(delta);
  return squared_distance_to_box(q) <= reach * reach;
}

static_assert(sizeof(PointTriangle) == 12 * sizeof(double), "the points are compared as one block");

bool nothing_moves(const PointTriangle& x0, const PointTriangle& x1) {
  // Bits are compared, so that +0 and −0 differ. The particle alone decides nearly always.
  // NOLINTBEGIN(bugprone-suspicious-memory-comparison)
  return std::memcmp(x0.p.data(), x1.p.data(), sizeof(Vec3)) == 0 &&
         std::memcmp(&x0, &x1, sizeof(PointTriangle)) == 0;
  // NOLINTEND(bugprone-suspicious-memory-comparison)
}

}  // namespace

ccd::Impact paths_intersect(const PointTriangle& x0, const PointTriangle& x1) {
  if (nothing_moves(x0, x1)) return {};
  return ccd::point_triangle({x0.p, x0.a, x0.b, x0.c, x1.p, x1.a, x1.b, x1.c});
}

EndDistance end_distance(const PointTriangle& q, double delta) {
  OILSKIN_ASSERT(delta > 0);
  const ClosestPoint c = closest_point(q.p, q.a, q.b, q.c);
  return {!certainly_far(q, c, delta) && box_is_close(q, delta), c.distance};
}

PointTriangle interpolate(const PointTriangle& x0, const PointTriangle& x1, double t) {
  OILSKIN_ASSERT(t >= 0 && t <= 1);
  return {x0.p + t * (x1.p - x0.p), x0.a + t * (x1.a - x0.a), x0.b + t * (x1.b - x0.b),
          x0.c + t * (x1.c - x0.c)};
}

}  // namespace oilskin::contact
