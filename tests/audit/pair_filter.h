/// Decides most pairs of a moving point and a moving triangle by plain arithmetic with error bounds; the rest
/// is left to exact arithmetic. Decides only what is certain.
#pragma once

#include <array>

#include "audit/motion_trace.h"

namespace oilskin::audit {

/// The point and the corners at the start and at the end of an interval.
struct Pair {
  std::array<Point, 4> start, end;
};

/// The closed paths are certainly disjoint.
bool certainly_apart(const Pair& pair);

/// The end distance is certainly at least `delta`.
bool certainly_beyond(const Pair& pair, double delta);

}  // namespace oilskin::audit
