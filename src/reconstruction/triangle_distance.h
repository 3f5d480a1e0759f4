/// Certified lower bounds of the distance of two triangles. A gap between their projections on a direction
/// proves that distance, for any direction. So the bound is safe for ill-conditioned closest features: at
/// worst it is too small.
#pragma once

#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// A lower bound of the distance of two closed triangles [m], rounding included; 0 if none was found. Within
/// rounding of the distance for triangles that are not slivers of a few ulp, unless a bound of `enough` is
/// found first.
double certified_distance(const Corners& t, const Corners& c,
                          double enough = std::numeric_limits<double>::infinity());

/// A prism around a triangle: the layer between two planes across its normal, cut by the three planes through
/// its edges that are perpendicular to it. The distances to layer and sides are orthogonal and together bound
/// the distance to the triangle (R.23). Exact if the nearest corner is over the face.
class TrianglePrism {
 public:
  explicit TrianglePrism(const Corners& c);
  struct Distance {
    double lower_bound;  ///< [m], rounding included
    bool is_exact;       ///< within rounding of the distance
  };
  /// Distance of t from the prism's triangle.
  Distance distance_from(const Corners& t) const;

 private:
  Vec3 origin_;
  Vec3 normal_ = Vec3::Zero();  ///< zero for a triangle without area: the bound is 0
  std::array<Vec3, 3> out_ = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  double low_ = 0, high_ = 0, size_ = 0;
  std::array<double, 3> reach_ = {0, 0, 0};  ///< extent of the triangle along out_
  bool is_complete_ = false;                 ///< all four directions are known
};

/// The same as certified_distance(t, c) > limit, with early exits.
bool certified_apart(const Corners& t, const Corners& c, double limit);

}  // namespace oilskin::reconstruction
