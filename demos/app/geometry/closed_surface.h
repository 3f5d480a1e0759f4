/// A closed cloth as the boundary of a volume.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::demo {

/// Winding numbers by counting the faces over a point, one grid of bins for all questions. While no point
/// meets the cloth its winding number cannot change, whatever the cloth does, even where it passes through
/// itself: that is what makes it a check of the contact code that shares nothing with it.
class ClosedSurface {
 public:
  /// The cloth as it is at x_t1, which must stay where it is.
  explicit ClosedSurface(const SurfaceMotion& cloth);

  /// Every edge is passed as often in one direction as in the other; otherwise nothing below has a meaning.
  bool closed() const;
  /// 1 inside of faces that face outwards, 0 outside.
  int winding_number(const Vec3& p) const;
  /// Enclosed, each part as often as its winding number says [m³].
  double volume() const;

 private:
  int bin(double x, int axis) const;
  int half_turn(std::uint32_t i, std::uint32_t j, const Vec3& p) const;
  bool below(const Vec3& p, const Triangle& t) const;

  const SurfaceMotion& cloth_;
  Box box_;
  std::vector<std::vector<std::uint32_t>> bins_;  ///< faces over each part of the plane y = 0
};

}  // namespace oilskin::demo
