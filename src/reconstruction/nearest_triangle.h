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
  ClosestPoint find(const Vec3& x) const { return find(x, reach_); }
  /// The same with a shorter reach.
  ClosestPoint find(const Vec3& x, double within) const;
  /// As find(), of the triangles whose closest point lies within 63° of the normal from x and within 23° of
  /// the normal of the triangle: obstacles that face the one with this normal. What is beside a triangle is
  /// not over it.
  ClosestPoint find_opposite(const Vec3& x, const Vec3& normal) const;
  /// Whether there are obstacles within `reach` [m] of x both ways along a line perpendicular to the normal,
  /// as in a tube.
  bool is_enclosed(const Vec3& x, const Vec3& normal, double reach) const;
  /// Calls f(t) for the triangles whose boxes are within `reach` of x, and perhaps for some more, ascending.
  template <class F>
  void for_within(const Vec3& x, double reach, const F& f) const {
    const double limit = with_rounding(x, reach);
    for (std::size_t c = 0; c < low_[0].size(); c += 8)
      for (std::uint32_t bits = 0xff & ~greater_mask(squared_distances(c, x), float(limit * limit));
           bits != 0; bits &= bits - 1)
        f(triangles_[c + std::size_t(__builtin_ctz(bits))]);
  }
  /// Prepares for is_any_between() and find_opposite(). The obstacles' normals must be prepared.
  void set_planes();
  /// Whether f(t) holds for a triangle whose plane and box the segment from p to q reaches; f may be asked
  /// about some more.
  template <class F>
  bool is_any_between(const Vec3& p, const Vec3& q, const F& f) const {
    const Between between(p - origin_, q - origin_, reach_);
    for (std::size_t c = 0; c < low_[0].size(); c += 8)
      for (std::uint32_t bits = between_mask(c, between); bits != 0; bits &= bits - 1)
        if (f(triangles_[c + std::size_t(__builtin_ctz(bits))])) return true;
    return false;
  }

 private:
  using F8 = simd::F8;
  /// A segment relative to the origin, its box, and what rounding to float may change.
  struct Between {
    std::array<float, 3> p, q, low, high;
    float rounding;

    Between(const Vec3& from, const Vec3& to, double reach);
  };
  /// The closest point that `accept` takes, in boxes c … c + 7 with a bit in may(c).
  template <class May, class Accept>
  ClosestPoint nearest(const Vec3& x, double within, const May& may, const Accept& accept) const;
  std::uint32_t between_mask(std::size_t c, const Between& segment) const;
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
  std::array<std::vector<float>, 3> normal_;      // unit, or 0 where a triangle has no area
  std::vector<float> offset_;                     // of the planes from the origin [m]
};

}  // namespace oilskin::reconstruction
