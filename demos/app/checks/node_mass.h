/// Masses of the nodes of cloth.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::demo {

/// Of a free node [kg], without the water that its host lets it carry.
inline double node_mass(const SurfaceMotion& motion, std::size_t node) {
  return 1 / motion.inverse_mass[node] - (motion.added_mass.empty() ? 0 : motion.added_mass[node]);
}

}  // namespace oilskin::demo
