/// What a particle's numbers must be to take part in a step.
#pragma once

#include "oilskin/types.h"

namespace oilskin::world {

/// Finite, and small enough that products of six of them do not overflow in the continuous test.
bool is_in_range(const Vec3& v);

}  // namespace oilskin::world
