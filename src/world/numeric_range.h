/// The range of positions, velocities and lengths that a step accepts.
#pragma once

#include "oilskin/types.h"

namespace oilskin::world {

/// Finite, and so small that products of six values do not overflow in the continuous test.
inline bool is_in_range(const Vec3& v) {
  return (v.array().abs() < 1e15).all();
}

/// Refuses a step that is not 1e-12 … 1e6 s.
Status check_dt(double dt);

}  // namespace oilskin::world
