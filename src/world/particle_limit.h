/// How many particles a world may have.
#pragma once

#include <limits>

#include "oilskin/settings.h"

namespace oilskin::world {

/// Where there are as many particles, none is added.
inline std::uint64_t particle_limit(const WorldSettings& settings) {
  return settings.max_particles > 0 ? settings.max_particles : std::numeric_limits<std::uint64_t>::max();
}

}  // namespace oilskin::world
