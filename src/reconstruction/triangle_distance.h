/// How far are two triangles apart, at least? A direction along which both project to intervals with a gap
/// proves that gap, however the direction was found. So the answer is safe where closest features are ill
/// conditioned: at worst it is too small.
#pragma once

#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// A lower bound of the distance of two closed triangles [m], rounding included; 0 where none was found.
/// Within rounding of the distance itself for triangles that are not slivers of a few ulp, unless it is
/// `enough`: then what was found first will do.
double certified_distance(const Corners& t, const Corners& c,
                          double enough = std::numeric_limits<double>::infinity());

/// What contains a triangle: the layer between two planes across its normal, and the inner sides of three
/// planes through its edges that stand on it. As these stand on those, the distances to both together bound
/// the triangle's (R.23); at little cost, and without loss where the nearest corner lies over the face.
class TrianglePrism {
 public:
  explicit TrianglePrism(const Corners& c);
  struct Distance {
    double at_least;  ///< [m], rounding included
    bool is_exact;    ///< no more than rounding below the distance
  };
  /// Of a triangle from the prism's.
  Distance distance_from(const Corners& t) const;

 private:
  Vec3 origin_;
  Vec3 normal_ = Vec3::Zero();  ///< zero where the triangle has none: then nothing is said
  std::array<Vec3, 3> out_ = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  double low_ = 0, high_ = 0, size_ = 0;
  std::array<double, 3> reach_ = {0, 0, 0};  ///< of the triangle along out_
  bool is_whole_ = false;                    ///< all four directions are known
};

/// Is it certain that the distance is more than `limit`? The same answer as certified_distance() > limit.
bool certified_apart(const Corners& t, const Corners& c, double limit);

}  // namespace oilskin::reconstruction
