/// Directions that certainly keep a moving point apart from a moving triangle. Internal to the room.
#pragma once

#include "ccd/point_triangle.h"

namespace oilskin::ccd::detail {

constexpr double kUnitRoundoff = 0x1p-53;

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

/// Cuts `span` down by separating directions until nothing is left (no hit) or a point in time resists (hit).
/// Needs no assumption on the input; work is bounded, and what exceeds the bound counts as a hit.
/// Everything before the returned time is certainly separated.
Meeting meet_by_subdivision(const RelativeMotion& motion, const TimeSpan& span);

}  // namespace oilskin::ccd::detail
