/// The nearest of some triangles, for many points near each other.
#pragma once

#include "core/closest_point.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

class NearestTriangle {
 public:
  /// Prepares for points in the box [m] and triangles within `reach` [m]. Their queries must be prepared.
  void set(const Obstacles& obstacles, const Box& points, double reach);
  /// The closest point of the obstacles; at the distance `reach` if there is none nearer. The first of
  /// several triangles that are as near.
  ClosestPoint find(const Vec3& x) const;

 private:
  const Obstacles* obstacles_ = nullptr;
  double reach_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<std::uint32_t> triangles_;
  std::array<std::vector<float>, 3> low_, high_;  // boxes relative to the origin, padded to a multiple of 8
};

}  // namespace oilskin::reconstruction
