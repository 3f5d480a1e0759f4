/// Random numbers as a function of (seed, counter): there is no state to save, and they are the same on every
/// platform, unlike the distributions of the standard library.
#pragma once

#include <cstdint>

namespace oilskin::fluid {

/// The output function of SplitMix64 [Steele2014].
inline std::uint64_t mix64(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

/// Uniform in [0, 1), 53 bits.
inline double random_unit(std::uint64_t seed, std::uint64_t counter) {
  return static_cast<double>(mix64(mix64(seed) ^ counter) >> 11) * 0x1p-53;
}

}  // namespace oilskin::fluid
