/// The pressure that nearly all of the water stays below.
#pragma once

#include "core/parallel.h"
#include "oilskin/types.h"

namespace oilskin::world {

/// A pressure that at most one particle in a thousand exceeds [Pa], up to an eighth too large; 0 where so
/// few have any. `pressure` ≥ 0, per particle. What a few particles between surfaces have does not count.
double upper_pressure(Span<const double> pressure, const Workers& workers);

}  // namespace oilskin::world
