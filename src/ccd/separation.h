/// Directions that certainly separate a moving point from a moving triangle. Internal to the module.
#pragma once

#include <array>

#include "ccd/point_triangle.h"

namespace oilskin::ccd::detail {

constexpr double unit_roundoff = 0x1p-53;

/// Corner minus point, per corner and axis, at both ends. One rounding per component: the relative error is
/// at most u and the sign is exact (IEEE subtraction underflows gradually, so it never rounds to zero).
struct RelativeMotion {
  double t0[3][3];
  double t1[3][3];
};

/// A closed interval of time within [0, 1].
struct TimeSpan {
  double begin = 0;
  double end = 1;

  double middle() const { return 0.5 * (begin + end); }
  double width() const { return end - begin; }
};

/// A lower bound of d·a for one corner at one end of the step (T.12), with a margin for the rounding of its
/// interpolation in time.
double lower_bound(const std::array<double, 3>& d, const double* a);

/// Removes from `span` the times at which a direction separates. True if nothing is left: point and triangle
/// are certainly apart. False if they touch, nearly touch, or take too many directions. Valid for any input.
bool certainly_apart(const RelativeMotion& motion, const TimeSpan& span);

}  // namespace oilskin::ccd::detail
