#include "reconstruction/triangle_distance.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/closest_point.h"

namespace oilskin::reconstruction {

namespace {

/// (R.19). The gap between the projections on n, less the rounding error; negative if they overlap. Corners
/// are relative to a corner of one triangle; `size` bounds their coordinates.
double gap_along(const Vec3& n, const Corners& t, const Corners& c, double size) {
  const double length = n.norm();
  if (!(length > 0 && std::isfinite(length))) return -1;
  const double t0 = n.dot(t[0]), t1 = n.dot(t[1]), t2 = n.dot(t[2]);
  const double c0 = n.dot(c[0]), c1 = n.dot(c[1]), c2 = n.dot(c[2]);
  const double t_low = std::min({t0, t1, t2}), t_high = std::max({t0, t1, t2});
  const double c_low = std::min({c0, c1, c2}), c_high = std::max({c0, c1, c2});
  const double gap = std::max(t_low - c_high, c_low - t_high);
  // Three products and two sums of each dot product, the corners' own rounding and the division by |n|.
  constexpr double rounding = 32 * 0x1p-53;
  return gap / length * (1 - rounding) - rounding * size;
}

struct Closest {
  Vec3 offset = Vec3::Zero();
  double squared = std::numeric_limits<double>::infinity();

  void offer(const Vec3& d) {
    const double s = d.squaredNorm();
    if (s < squared) {
      squared = s;
      offset = d;
    }
  }
};

/// Closest points of two segments ([Ericson2005] 5.1.9).
Vec3 between_segments(const Vec3& p, const Vec3& p1, const Vec3& q, const Vec3& q1) {
  const Vec3 u = p1 - p, v = q1 - q, r = p - q;
  const double a = u.squaredNorm(), e = v.squaredNorm(), f = v.dot(r), c = u.dot(r), b = u.dot(v);
  const auto unit = [](double x) { return x > 0 ? (x < 1 ? x : 1) : 0; };
  const double denominator = a * e - b * b;
  double s = denominator > 0 ? unit((b * f - c * e) / denominator) : 0;
  double t = e > 0 ? (b * s + f) / e : 0;
  if (!(t >= 0 && t <= 1)) {
    t = unit(t);
    s = a > 0 ? unit((b * t - c) / a) : 0;
  }
  return r + s * u - t * v;
}

Vec3 closest_offset(const Corners& t, const Corners& c) {
  Closest best;
  for (const Vec3& p : t) best.offer(closest_point(p, c[0], c[1], c[2]).offset);
  for (const Vec3& p : c) best.offer(closest_point(p, t[0], t[1], t[2]).offset);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      best.offer(between_segments(t[i], t[(i + 1) % 3], c[j], c[(j + 1) % 3]));
  return best.offset;
}

struct Local {
  Corners t, c;
  double size;

  Local(const Corners& triangle, const Corners& other) {
    const Vec3& o = triangle[0];
    size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] = triangle[k] - o;
      c[k] = other[k] - o;
      size = std::max({size, t[k].cwiseAbs().maxCoeff(), c[k].cwiseAbs().maxCoeff()});
    }
    OILSKIN_ASSERT(std::isfinite(size));
  }
  double along_normal(const Corners& of) const {
    return gap_along((of[1] - of[0]).cross(of[2] - of[0]), t, c, size);
  }
  double along_closest() const { return gap_along(closest_offset(t, c), t, c, size); }
};

}  // namespace

TrianglePrism::TrianglePrism(const Corners& c) : origin_(c[0]) {
  const Corners relative = {Vec3::Zero(), c[1] - origin_, c[2] - origin_};
  for (const Vec3& x : relative) size_ = std::max(size_, x.cwiseAbs().maxCoeff());
  const Vec3 cross = relative[1].cross(relative[2]);
  const double length = cross.norm();
  if (!(length > 0 && std::isfinite(length))) return;
  normal_ = cross / length;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = normal_.dot(relative[k]);
    low_ = std::min(low_, along);
    high_ = std::max(high_, along);
  }
  is_complete_ = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = relative[(k + 1) % 3] - relative[k], out = edge.cross(normal_);
    // The normal of a sliver is inaccurate: a side is used only if it is certainly perpendicular to the
    // layer.
    if (!(out.squaredNorm() > 0.25 * edge.squaredNorm())) {
      is_complete_ = false;
      continue;
    }
    out_[k] = out.normalized();
    reach_[k] = std::max({0.0, out_[k].dot(relative[1]), out_[k].dot(relative[2])});
  }
}

TrianglePrism::Distance TrianglePrism::distance_from(const Corners& t) const {
  std::array<double, 3> along, beyond;  // of each corner: along the normal, beyond the edges
  Vec3 beside = Vec3::Constant(std::numeric_limits<double>::infinity());
  double size = size_;
  for (std::size_t j = 0; j < 3; ++j) {
    const Vec3 x = t[j] - origin_;
    size = std::max(size, x.cwiseAbs().maxCoeff());
    along[j] = normal_.dot(x);
    const Vec3 out(out_[0].dot(x) - reach_[0], out_[1].dot(x) - reach_[1], out_[2].dot(x) - reach_[2]);
    beyond[j] = out.maxCoeff();
    beside = beside.cwiseMin(out);
  }
  const double low = std::min({along[0], along[1], along[2]}),
               high = std::max({along[0], along[1], along[2]}),
               off = std::max({0.0, low - high_, low_ - high}), to_side = std::max(0.0, beside.maxCoeff());
  bool over_face = false;
  for (std::size_t j = 0; j < 3; ++j) over_face |= beyond[j] <= 0 && along[j] == (low > high_ ? low : high);
  // Twice the term of gap_along(), and a margin since the planes are perpendicular only to some ulps.
  constexpr double rounding = 96 * 0x1p-53;
  const double distance = std::sqrt(off * off + to_side * to_side);
  return {std::max(0.0, distance * (1 - rounding) - rounding * size), is_complete_ && off > 0 && over_face};
}

double certified_distance(const Corners& triangle, const Corners& other, double enough) {
  const Local l(triangle, other);
  double d = std::max(0.0, l.along_normal(l.c));
  if (d < enough) d = std::max(d, l.along_normal(l.t));
  return d < enough ? std::max(d, l.along_closest()) : d;
}

bool certified_apart(const Corners& triangle, const Corners& other, double limit) {
  const Local l(triangle, other);
  return l.along_normal(l.c) > limit || l.along_normal(l.t) > limit || l.along_closest() > limit;
}

}  // namespace oilskin::reconstruction
