#include "core/closest_point.h"

#include <cmath>

#include "core/assert.h"

namespace oilskin {

namespace {

// Corners are relative to the query point.
ClosestPoint from_weights(const Vec3& a, const Vec3& b, const Vec3& c, double wa, double wb, double wc) {
  OILSKIN_ASSERT(std::abs(wa + wb + wc - 1) < 1e-12 || std::isnan(wa + wb + wc));  // NaN in, NaN out
  ClosestPoint r;
  r.weights = {wa, wb, wc};
  r.offset = -(wa * a + wb * b + wc * c);
  r.distance = r.offset.norm();
  r.feature = static_cast<std::uint8_t>((wa != 0) | (wb != 0) << 1 | (wc != 0) << 2);
  return r;
}

// Parameter of the point of the segment u → v that is closest to the origin; 0 for a segment without length.
double segment_parameter(const Vec3& u, const Vec3& v) {
  const Vec3 e = v - u;
  const double l2 = e.squaredNorm();
  if (!(l2 > 0)) return 0;
  const double t = -u.dot(e) / l2;
  return t <= 0 ? 0 : (t >= 1 ? 1 : t);
}

/// The point at the parameter t of an edge: 0 from a to b, 1 from b to c, 2 from c to a.
ClosestPoint on_edge(const Vec3& a, const Vec3& b, const Vec3& c, int edge, double t) {
  if (edge == 0) return from_weights(a, b, c, 1 - t, t, 0);
  if (edge == 1) return from_weights(a, b, c, 0, 1 - t, t);
  return from_weights(a, b, c, t, 0, 1 - t);
}

ClosestPoint closest_of_segments(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double t[3] = {segment_parameter(a, b), segment_parameter(b, c), segment_parameter(c, a)};
  const double d2[3] = {((1 - t[0]) * a + t[0] * b).squaredNorm(), ((1 - t[1]) * b + t[1] * c).squaredNorm(),
                        ((1 - t[2]) * c + t[2] * a).squaredNorm()};
  int best = 0;
  for (int k = 1; k < 3; ++k)
    if (d2[k] < d2[best]) best = k;
  return on_edge(a, b, c, best, t[best]);
}

}  // namespace

ClosestPoint closest_point(const Vec3& p, const Vec3& pa, const Vec3& pb, const Vec3& pc) {
  const Vec3 a = pa - p, b = pb - p, c = pc - p;
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const Vec3 n = ab.cross(ac);
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
  const double n2 = n.squaredNorm();
  if (!(n2 > 1e-14 * longest2 * longest2)) return closest_of_segments(a, b, c);

  // Signed areas of the projections: the face is closest when all are positive.
  const double wa = n.dot(b.cross(c));
  const double wb = n.dot(c.cross(a));
  const double wc = n.dot(a.cross(b));
  if (wa > 0 && wb > 0 && wc > 0) {
    const double sum = wa + wb + wc;
    return from_weights(a, b, c, wa / sum, wb / sum,
                        1 - wa / sum - wb / sum > 0 ? 1 - wa / sum - wb / sum : 0);
  }
  // Outside of an edge and between its ends, that edge is closest. For thin triangles rounding may decide on
  // which side of an edge the point is.
  constexpr double margin = 1e-3, thin = 1e-6;
  if (n2 > thin * longest2 * longest2) {
    const Vec3* const corner[3] = {&a, &b, &c};
    const double inside[3] = {wc, wa, wb};
    for (int edge = 0; edge < 3; ++edge) {
      if (!(inside[edge] < 0)) continue;
      const double t = segment_parameter(*corner[edge], *corner[(edge + 1) % 3]);
      if (t > margin && t < 1 - margin) return on_edge(a, b, c, edge, t);
    }
  }
  return closest_of_segments(a, b, c);
}

}  // namespace oilskin
