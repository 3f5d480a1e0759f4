/// What lies in the shadow of a cloth when the light falls along gravity.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::demo {

class Shadow {
 public:
  /// The cloth as it is at x_t1; `down` has any length > 0.
  Shadow(const SurfaceMotion& cloth, const Vec3& down);

  /// Below the cloth, and farther than `margin` [m] from the border of its shadow.
  bool covers(const Vec3& p, double margin) const;

 private:
  using Point = Eigen::Vector2d;
  struct Flat {
    Point a, b, c;
    double height_a, height_b, height_c;
  };

  Point flat(const Vec3& p) const { return {p.dot(u_), p.dot(v_)}; }
  std::size_t bin(const Point& p) const;
  bool below(const Point& p, double height) const;

  Vec3 u_, v_, up_;
  Point min_, max_;
  std::vector<Flat> triangles_;
  std::vector<std::vector<std::uint32_t>> bins_;
  std::vector<std::array<Point, 2>> border_;
};

}  // namespace oilskin::demo
