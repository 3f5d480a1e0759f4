/// What is found out without exact polynomials: by plain arithmetic with error bounds, and by exact
/// determinants at the ends of the step. Internal to the room.
#pragma once

#include "ccd/separation.h"

namespace oilskin::ccd::detail {

enum class Verdict { kApart, kImpact, kUnclear };

struct FilterResult {
  Verdict verdict = Verdict::kApart;
  /// kImpact: begins not later than the first meeting. kUnclear: nothing meets before it, something may in
  /// it.
  TimeSpan span;
};

/// kApart and kImpact are certain.
FilterResult filter(const PointTriangleMotion& m);

}  // namespace oilskin::ccd::detail
