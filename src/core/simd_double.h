/// Four doubles at a time. All versions do the same IEEE operations in the same order, so they give the same
/// bits.
#pragma once

#include <cmath>

#include "core/simd.h"

namespace oilskin::simd {

#if defined(OILSKIN_VECTOR_EXTENSIONS) && defined(__SSE2__)

struct D4 {
  __m128d low, high;
  D4() : low(_mm_setzero_pd()), high(_mm_setzero_pd()) {}
  D4(__m128d l, __m128d h) : low(l), high(h) {}
  D4(double a)
      : low(_mm_set1_pd(a)), high(low) {}  // NOLINT(google-explicit-constructor): broadcasts constants
  D4(double a, double b, double c, double d) : low(_mm_setr_pd(a, b)), high(_mm_setr_pd(c, d)) {}

  /// No alignment is needed.
  static D4 load(const double* p) { return {_mm_loadu_pd(p), _mm_loadu_pd(p + 2)}; }
  void store(double* p) const {
    _mm_storeu_pd(p, low);
    _mm_storeu_pd(p + 2, high);
  }
};

/// Four truth values.
struct Mask4 {
  __m128d low, high;
};

inline D4 operator+(const D4& a, const D4& b) {
  return {_mm_add_pd(a.low, b.low), _mm_add_pd(a.high, b.high)};
}
inline D4 operator-(const D4& a, const D4& b) {
  return {_mm_sub_pd(a.low, b.low), _mm_sub_pd(a.high, b.high)};
}
inline D4 operator*(const D4& a, const D4& b) {
  return {_mm_mul_pd(a.low, b.low), _mm_mul_pd(a.high, b.high)};
}
inline D4 operator/(const D4& a, const D4& b) {
  return {_mm_div_pd(a.low, b.low), _mm_div_pd(a.high, b.high)};
}
inline D4 root(const D4& a) {
  return {_mm_sqrt_pd(a.low), _mm_sqrt_pd(a.high)};
}
inline Mask4 operator>(const D4& a, const D4& b) {
  return {_mm_cmpgt_pd(a.low, b.low), _mm_cmpgt_pd(a.high, b.high)};
}
inline Mask4 operator&(const Mask4& a, const Mask4& b) {
  return {_mm_and_pd(a.low, b.low), _mm_and_pd(a.high, b.high)};
}
/// `a` where the mask is true, else `b`.
inline D4 choose(const Mask4& mask, const D4& a, const D4& b) {
  return {_mm_or_pd(_mm_and_pd(mask.low, a.low), _mm_andnot_pd(mask.low, b.low)),
          _mm_or_pd(_mm_and_pd(mask.high, a.high), _mm_andnot_pd(mask.high, b.high))};
}

#else

struct D4 {
  double v[4];
  D4(double a = 0) : v{a, a, a, a} {}  // NOLINT(google-explicit-constructor): broadcasts constants
  D4(double a, double b, double c, double d) : v{a, b, c, d} {}
  static D4 load(const double* p) { return {p[0], p[1], p[2], p[3]}; }
  void store(double* p) const {
    for (int k = 0; k < 4; ++k) p[k] = v[k];
  }
};

/// Four truth values.
struct Mask4 {
  bool v[4];
};

/// f(k) for the four places.
template <class F>
D4 of_doubles(const F& f) {
  return {f(0), f(1), f(2), f(3)};
}
inline D4 operator+(const D4& a, const D4& b) {
  return of_doubles([&](int k) { return a.v[k] + b.v[k]; });
}
inline D4 operator-(const D4& a, const D4& b) {
  return of_doubles([&](int k) { return a.v[k] - b.v[k]; });
}
inline D4 operator*(const D4& a, const D4& b) {
  return of_doubles([&](int k) { return a.v[k] * b.v[k]; });
}
inline D4 operator/(const D4& a, const D4& b) {
  return of_doubles([&](int k) { return a.v[k] / b.v[k]; });
}
inline D4 root(const D4& a) {
  return of_doubles([&](int k) { return std::sqrt(a.v[k]); });
}
inline Mask4 operator>(const D4& a, const D4& b) {
  return {{a.v[0] > b.v[0], a.v[1] > b.v[1], a.v[2] > b.v[2], a.v[3] > b.v[3]}};
}
inline Mask4 operator&(const Mask4& a, const Mask4& b) {
  return {{a.v[0] && b.v[0], a.v[1] && b.v[1], a.v[2] && b.v[2], a.v[3] && b.v[3]}};
}
/// `a` where the mask is true, else `b`.
inline D4 choose(const Mask4& mask, const D4& a, const D4& b) {
  return of_doubles([&](int k) { return mask.v[k] ? a.v[k] : b.v[k]; });
}

#endif

}  // namespace oilskin::simd
