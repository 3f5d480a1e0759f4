/// Parts of a vector, for what is taken back up to a limit.
#pragma once

#include <algorithm>

#include "oilskin/types.h"

namespace oilskin {

/// The part of v along `whole`, from `least` to `most` times it; 0 where `whole` is 0.
inline Vec3 clamped_part(const Vec3& v, const Vec3& whole, double least, double most) {
  const double square = whole.squaredNorm();
  return square > 0 ? Vec3(std::clamp(v.dot(whole) / square, least, most) * whole) : Vec3::Zero();
}

}  // namespace oilskin
