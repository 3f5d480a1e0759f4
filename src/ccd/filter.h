/// The filter of the continuous test: double arithmetic with error bounds, and exact determinants at the ends
/// of the step. Internal to the module.
#pragma once

#include "ccd/separation.h"

namespace oilskin::ccd::detail {

enum class Verdict { apart, impact, unclear };

struct FilterResult {
  Verdict verdict = Verdict::apart;
  /// impact: does not begin after the first touch. unclear: no touch before the span, perhaps one within it.
  TimeSpan span;
};

/// The verdicts apart and impact are certain.
FilterResult filter(const PointTriangleMotion& m);

}  // namespace oilskin::ccd::detail
