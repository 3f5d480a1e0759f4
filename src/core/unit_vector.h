/// Directions of vectors that may be zero.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// v/|v|; 0 for 0. Eigen's stableNormalized() divides 0 by 0 then, which ends a program that traps
/// FE_INVALID.
inline Vec3 unit_or_zero(const Vec3& v) {
  return v.isZero(0) ? Vec3(Vec3::Zero()) : Vec3(v.stableNormalized());
}

}  // namespace oilskin
