/// Masses of nodes: which inverse masses contact accepts, and what a node weighs.
#pragma once

#include <cmath>

#include "oilskin/surface_motion.h"

namespace oilskin {

/// 0 (infinite mass), or finite and so large that momentum and energy are finite for speeds below 1e15 m/s.
inline bool is_inverse_mass(double u) {
  return u == 0 || (u >= 1e-200 && std::isfinite(u));
}

inline constexpr const char* inverse_mass_range = "0, or finite and ≥ 1e-200 1/kg";

/// Of a node that is not prescribed [kg], without the water that its host lets it carry.
inline double own_mass(const SurfaceMotion& m, std::size_t node) {
  return 1 / m.inverse_mass[node] - (m.added_mass.empty() ? 0 : m.added_mass[node]);
}

}  // namespace oilskin
