/// Random numbers for tests: the same on every platform (the standard's distributions are not).
#pragma once

#include <cmath>
#include <cstdint>

#include "oilskin/types.h"

namespace oilskin::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ull + 1) {}

  std::uint64_t bits() {  // splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform()); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }
  Vec3 in_cube(double half) { return Vec3(uniform(-half, half), uniform(-half, half), uniform(-half, half)); }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = in_cube(1);
      const double l = v.norm();
      if (l > 0.1 && l <= 1) return v / l;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace oilskin::test
