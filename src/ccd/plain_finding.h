/// What plain arithmetic with error bounds finds out. Internal to the room.
#pragma once

#include "ccd/point_triangle.h"

namespace oilskin::ccd::detail {

enum class Verdict { kApart, kMeet, kUnclear };

struct Finding {
  Verdict verdict = Verdict::kApart;
  double time = 1;  ///< of the first meeting, not late (kMeet only)
};

/// kApart and kMeet are certain.
Finding plain_finding(const PointTriangleMotion& m);

}  // namespace oilskin::ccd::detail
