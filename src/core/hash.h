/// A 64-bit running hash of bit patterns, for comparing states.
#pragma once

#include <cstdint>
#include <cstring>

#include "oilskin/types.h"

namespace oilskin {

class Hash64 {
 public:
  void add(std::uint64_t bits) {
    // One round of the finaliser of MurmurHash3 per word. Depends on the order.
    state_ ^= bits + 0x9e3779b97f4a7c15ull + (state_ << 6) + (state_ >> 2);
    state_ ^= state_ >> 33;
    state_ *= 0xff51afd7ed558ccdull;
    state_ ^= state_ >> 33;
  }
  void add(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    add(bits);
  }
  void add(const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x6f696c736b696eull;  // "oilskin"
};

}  // namespace oilskin
