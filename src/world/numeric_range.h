/// The range of positions and velocities that a step accepts.
#pragma once

#include "oilskin/types.h"

namespace oilskin::world {

/// Finite, and so small that products of six values do not overflow in the continuous test.
bool is_in_range(const Vec3& v);

}  // namespace oilskin::world
