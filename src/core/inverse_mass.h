/// The inverse masses that contact accepts.
#pragma once

#include <cmath>

namespace oilskin {

/// 0 (infinite mass), or finite and so large that momentum and energy are finite for speeds below 1e15 m/s.
inline bool is_inverse_mass(double u) {
  return u == 0 || (u >= 1e-200 && std::isfinite(u));
}

inline constexpr const char* inverse_mass_range = "0, or finite and ≥ 1e-200 1/kg";

}  // namespace oilskin
