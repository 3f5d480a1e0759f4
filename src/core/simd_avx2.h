/// Eight floats in one register: the names of core/simd.h for translation units compiled for AVX2, in a
/// namespace of their own. The linker may keep any copy of an inline function: one that it takes from such a
/// unit must not have the name of one that other units call. Same IEEE operations in the same order as F8.
#pragma once

#include <immintrin.h>

#include "core/simd.h"
#include "core/simd_double.h"

namespace oilskin::simd::avx2 {

struct F8 {
  __m256 v;
  F8() : v(_mm256_setzero_ps()) {}
  F8(__m256 a) : v(a) {}                 // NOLINT(google-explicit-constructor): a wrapper
  F8(float a) : v(_mm256_set1_ps(a)) {}  // NOLINT(google-explicit-constructor): broadcasts constants

  /// No alignment is needed.
  static F8 load(const float* p) { return _mm256_loadu_ps(p); }
  static F8 gather(const float* p, const std::uint32_t* i) {
    return _mm256_setr_ps(p[i[0]], p[i[1]], p[i[2]], p[i[3]], p[i[4]], p[i[5]], p[i[6]], p[i[7]]);
  }
  void store(float* p) const { _mm256_storeu_ps(p, v); }
};

inline F8 operator+(F8 a, F8 b) {
  return _mm256_add_ps(a.v, b.v);
}
inline F8 operator-(F8 a, F8 b) {
  return _mm256_sub_ps(a.v, b.v);
}
inline F8 operator*(F8 a, F8 b) {
  return _mm256_mul_ps(a.v, b.v);
}
inline F8 operator/(F8 a, F8 b) {
  return _mm256_div_ps(a.v, b.v);
}
inline void operator+=(F8& a, F8 b) {
  a = a + b;
}
inline F8 larger(F8 a, F8 b) {
  return _mm256_max_ps(a.v, b.v);
}
inline F8 smaller(F8 a, F8 b) {
  return _mm256_min_ps(a.v, b.v);
}
inline F8 root(F8 a) {
  return _mm256_sqrt_ps(a.v);
}
inline std::uint32_t greater_mask(F8 a, F8 b) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)));
}
inline float total(F8 a) {
  alignas(16) float s[4];
  _mm_store_ps(s, _mm_add_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1)));
  return (s[0] + s[2]) + (s[1] + s[3]);
}

/// `a` where `x` is positive, else `b`.
inline F8 choose_positive(F8 x, F8 a, F8 b) {
  return _mm256_blendv_ps(b.v, a.v, _mm256_cmp_ps(x.v, _mm256_setzero_ps(), _CMP_GT_OQ));
}

struct Sum8 {
  __m256d low = _mm256_setzero_pd(), high = _mm256_setzero_pd();
  static __m256d low_of(F8 a) { return _mm256_cvtps_pd(_mm256_castps256_ps128(a.v)); }
  static __m256d high_of(F8 a) { return _mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1)); }
  void operator+=(F8 a) {
    low = _mm256_add_pd(low, low_of(a));
    high = _mm256_add_pd(high, high_of(a));
  }
  void add_product(F8 a, F8 b) {
    low = _mm256_add_pd(low, _mm256_mul_pd(low_of(a), low_of(b)));
    high = _mm256_add_pd(high, _mm256_mul_pd(high_of(a), high_of(b)));
  }
  double total() const {
    alignas(32) double s[4];
    _mm256_store_pd(s, _mm256_add_pd(low, high));
    return (s[0] + s[2]) + (s[1] + s[3]);
  }
};

struct Record8 {
  F8 x, y, z, w;
  Record8(const Record* r, const std::uint32_t* i)
      : Record8(both(r[i[0]], r[i[4]]), both(r[i[1]], r[i[5]]), both(r[i[2]], r[i[6]]),
                both(r[i[3]], r[i[7]])) {}
  explicit Record8(const Record* r)
      : Record8(both(r[0], r[4]), both(r[1], r[5]), both(r[2], r[6]), both(r[3], r[7])) {}

 private:
  Record8(__m256 a, __m256 b, __m256 c, __m256 d) {
    const __m256 ab_xy = _mm256_unpacklo_ps(a, b), cd_xy = _mm256_unpacklo_ps(c, d);
    const __m256 ab_zw = _mm256_unpackhi_ps(a, b), cd_zw = _mm256_unpackhi_ps(c, d);
    x = _mm256_shuffle_ps(ab_xy, cd_xy, _MM_SHUFFLE(1, 0, 1, 0));
    y = _mm256_shuffle_ps(ab_xy, cd_xy, _MM_SHUFFLE(3, 2, 3, 2));
    z = _mm256_shuffle_ps(ab_zw, cd_zw, _MM_SHUFFLE(1, 0, 1, 0));
    w = _mm256_shuffle_ps(ab_zw, cd_zw, _MM_SHUFFLE(3, 2, 3, 2));
  }
  static __m256 both(const Record& first, const Record& second) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&first.x)), _mm_load_ps(&second.x), 1);
  }
};

/// Four doubles in one register: the names of core/simd_double.h.
struct D4 {
  __m256d v;
  D4() : v(_mm256_setzero_pd()) {}
  D4(__m256d a) : v(a) {}                 // NOLINT(google-explicit-constructor): a wrapper
  D4(double a) : v(_mm256_set1_pd(a)) {}  // NOLINT(google-explicit-constructor): broadcasts constants
  D4(double a, double b, double c, double d) : v(_mm256_setr_pd(a, b, c, d)) {}

  /// No alignment is needed.
  static D4 load(const double* p) { return _mm256_loadu_pd(p); }
  void store(double* p) const { _mm256_storeu_pd(p, v); }
};

struct Mask4 {
  __m256d v;
};

inline D4 operator+(D4 a, D4 b) {
  return _mm256_add_pd(a.v, b.v);
}
inline D4 operator-(D4 a, D4 b) {
  return _mm256_sub_pd(a.v, b.v);
}
inline D4 operator*(D4 a, D4 b) {
  return _mm256_mul_pd(a.v, b.v);
}
inline D4 operator/(D4 a, D4 b) {
  return _mm256_div_pd(a.v, b.v);
}
inline D4 root(D4 a) {
  return _mm256_sqrt_pd(a.v);
}
inline Mask4 operator>(D4 a, D4 b) {
  return {_mm256_cmp_pd(a.v, b.v, _CMP_GT_OQ)};
}
inline Mask4 operator&(Mask4 a, Mask4 b) {
  return {_mm256_and_pd(a.v, b.v)};
}
inline D4 choose(Mask4 mask, D4 a, D4 b) {
  return _mm256_blendv_pd(b.v, a.v, mask.v);
}

}  // namespace oilskin::simd::avx2
