/// The nearest of some triangles, for many points near each other.
#pragma once

#include "core/closest_point.h"
#include "core/simd.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

class NearestTriangle {
 public:
  /// Prepares for points in the box [m] and triangles within `reach` [m]. Their queries must be prepared.
  void set(const Obstacles& obstacles, const Box& points, double reach);
  /// The closest point of the obstacles; at the distance `reach` if there is none nearer. The first of
  /// several triangles that are as near.
  ClosestPoint find(const Vec3& x) const;
  /// Calls f(t) for the triangles whose boxes are within `reach` of x, and perhaps for some more, ascending.
  template <class F>
  void for_within(const Vec3& x, double reach, const F& f) const {
    const double limit = with_rounding(x, reach);
    for (std::size_t c = 0; c < low_[0].size(); c += 8)
      for (std::uint32_t bits = 0xff & ~greater_mask(squared_distances(c, x), float(limit * limit));
           bits != 0; bits &= bits - 1)
        f(triangles_[c + std::size_t(__builtin_ctz(bits))]);
  }

 private:
  using F8 = simd::F8;
  /// Of x from boxes c … c + 7.
  F8 squared_distances(std::size_t c, const Vec3& x) const;
  /// Boxes are rounded to float.
  double with_rounding(const Vec3& x, double distance) const {
    return 1.00001 * (distance + 1e-6 * ((x - origin_).cwiseAbs().maxCoeff() + reach_));
  }

  const Obstacles* obstacles_ = nullptr;
  double reach_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<std::uint32_t> triangles_;
  std::array<std::vector<float>, 3> low_, high_;  // boxes relative to the origin, padded to a multiple of 8
};

}  // namespace oilskin::reconstruction
