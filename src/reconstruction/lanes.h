/// Eight floats at a time, the width of a row of nodes: with vector extensions of the compiler, or as a plain
/// array (define OILSKIN_SCALAR). Both do the same IEEE operations in the same order, so the same bits.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__has_builtin) && !defined(OILSKIN_SCALAR)
#if __has_builtin(__builtin_shufflevector)
#define OILSKIN_LANES 1
#endif
#endif
#if defined(OILSKIN_LANES) && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace oilskin::reconstruction {

struct Lanes {
#if defined(OILSKIN_LANES)
  using V = float __attribute__((vector_size(16)));
  V low{}, high{};
  Lanes() = default;
  Lanes(V l, V h) : low(l), high(h) {}
  Lanes(float x) : low{x, x, x, x}, high{x, x, x, x} {}  // NOLINT(google-explicit-constructor): constants
#else
  float at[8] = {};
  Lanes() = default;
  Lanes(float x) {  // NOLINT(google-explicit-constructor)
    for (float& a : at) a = x;
  }
#endif
  static Lanes load(const float* p) {
    Lanes r;
    std::memcpy(static_cast<void*>(&r), p, sizeof r);
    return r;
  }
  void store(float* p) const {
    std::memcpy(p, this, sizeof *this);
  }
};
static_assert(sizeof(Lanes) == 8 * sizeof(float), "eight floats, nothing else");

#if defined(OILSKIN_LANES)
inline Lanes operator+(const Lanes& a, const Lanes& b) {
  return {a.low + b.low, a.high + b.high};
}
inline Lanes operator-(const Lanes& a, const Lanes& b) {
  return {a.low - b.low, a.high - b.high};
}
inline Lanes operator*(const Lanes& a, const Lanes& b) {
  return {a.low * b.low, a.high * b.high};
}
/// 0 where not positive.
inline Lanes positive_part(const Lanes& a) {
  const Lanes::V zero{};
  return {a.low > zero ? a.low : zero, a.high > zero ? a.high : zero};
}
inline Lanes largest(const Lanes& a, const Lanes& b) {
  return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}
inline Lanes smallest(const Lanes& a, const Lanes& b) {
  return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high};
}
#else
template <class F>
Lanes each(const F& f) {
  Lanes r;
  for (int i = 0; i < 8; ++i) r.at[i] = f(i);
  return r;
}
inline Lanes operator+(const Lanes& a, const Lanes& b) {
  return each([&](int i) { return a.at[i] + b.at[i]; });
}
inline Lanes operator-(const Lanes& a, const Lanes& b) {
  return each([&](int i) { return a.at[i] - b.at[i]; });
}
inline Lanes operator*(const Lanes& a, const Lanes& b) {
  return each([&](int i) { return a.at[i] * b.at[i]; });
}
inline Lanes positive_part(const Lanes& a) {
  return each([&](int i) { return a.at[i] > 0 ? a.at[i] : 0.0f; });
}
inline Lanes largest(const Lanes& a, const Lanes& b) {
  return each([&](int i) { return a.at[i] > b.at[i] ? a.at[i] : b.at[i]; });
}
inline Lanes smallest(const Lanes& a, const Lanes& b) {
  return each([&](int i) { return a.at[i] < b.at[i] ? a.at[i] : b.at[i]; });
}
#endif

/// Numbers of a row's nodes.
constexpr float node_numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};

/// Bit i: lane i of a is larger than that of b.
inline std::uint32_t larger(const Lanes& a, const Lanes& b) {
#if defined(OILSKIN_LANES) && defined(__SSE2__)
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpgt_ps(a.low, b.low)) |
                                    _mm_movemask_ps(_mm_cmpgt_ps(a.high, b.high)) << 4);
#else
  float x[8], y[8];
  a.store(x);
  b.store(y);
  std::uint32_t bits = 0;
  for (int i = 0; i < 8; ++i) bits |= static_cast<std::uint32_t>(x[i] > y[i]) << i;
  return bits;
#endif
}

/// 0 in the lanes of which bits are set.
inline Lanes without(const Lanes& a, std::uint32_t bits) {
  float x[8];
  a.store(x);
  for (; bits != 0; bits &= bits - 1) x[__builtin_ctz(bits)] = 0;
  return Lanes::load(x);
}

}  // namespace oilskin::reconstruction
