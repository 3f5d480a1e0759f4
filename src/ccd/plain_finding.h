/// What is found out without exact polynomials: by plain arithmetic with error bounds, and by exact
/// determinants at the ends of the step. Internal to the room.
#pragma once

#include "ccd/separation.h"

namespace oilskin::ccd::detail {

enum class Verdict { kApart, kMeet, kUnclear };

struct Finding {
  Verdict verdict = Verdict::kApart;
  /// kMeet: begins not later than the first meeting. kUnclear: nothing meets before it, something may in it.
  TimeSpan span;
};

/// kApart and kMeet are certain.
Finding plain_finding(const PointTriangleMotion& m);

}  // namespace oilskin::ccd::detail
