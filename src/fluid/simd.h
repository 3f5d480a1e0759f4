/// Vectors of four floats for the pair loops, by vector extensions of the compiler or as plain arrays (define
/// OILSKIN_SCALAR). Both do the same IEEE operations in the same order and have the same results bit for bit.
#pragma once

#include <cmath>
#include <cstdint>

#if defined(__has_builtin) && !defined(OILSKIN_SCALAR)
#if __has_builtin(__builtin_shufflevector) && __has_builtin(__builtin_convertvector)
#define OILSKIN_VECTOR_EXTENSIONS 1
#endif
#endif
#if defined(OILSKIN_VECTOR_EXTENSIONS) && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace oilskin::fluid {

/// Values of a neighbour that a pair loop reads in one 16-byte load.
struct alignas(16) Record {
  float x, y, z, w;
};

#if defined(OILSKIN_VECTOR_EXTENSIONS)

struct F4 {
  using V = float __attribute__((vector_size(16)));
  V v;
  F4() : v{} {}
  F4(V a) : v(a) {}               // NOLINT(google-explicit-constructor): a wrapper
  F4(float a) : v{a, a, a, a} {}  // NOLINT(google-explicit-constructor): broadcasts constants
  float operator[](int k) const { return v[k]; }
};

inline F4 operator+(F4 a, F4 b) {
  return a.v + b.v;
}
inline F4 operator-(F4 a, F4 b) {
  return a.v - b.v;
}
inline F4 operator*(F4 a, F4 b) {
  return a.v * b.v;
}
inline F4 operator/(F4 a, F4 b) {
  return a.v / b.v;
}
inline F4 larger(F4 a, F4 b) {
  return a.v > b.v ? a.v : b.v;
}
#if defined(__SSE2__)
inline F4 root(F4 a) {
  return F4::V(_mm_sqrt_ps(a.v));
}
#else
inline F4 root(F4 a) {
  return F4::V{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
#endif

inline F4 load(const float* p) {
  return *reinterpret_cast<const F4::V*>(p);
}
inline void store(float* p, F4 a) {
  *reinterpret_cast<F4::V*>(p) = a.v;
}
inline F4 gather(const float* p, const std::uint32_t* index) {
  return F4::V{p[index[0]], p[index[1]], p[index[2]], p[index[3]]};
}

/// Sums of floats in double: antisymmetric terms cancel to 1e-16.
struct Sum4 {
  using D = double __attribute__((vector_size(16)));
  D low{}, high{};
  void operator+=(F4 a) {
    low += __builtin_convertvector(__builtin_shufflevector(a.v, a.v, 0, 1), D);
    high += __builtin_convertvector(__builtin_shufflevector(a.v, a.v, 2, 3), D);
  }
  double total() const { return (low[0] + high[0]) + (low[1] + high[1]); }
};

/// Four records, transposed: x[k] is that of the k-th record.
struct Record4 {
  F4 x, y, z, w;
  Record4(const Record* r, const std::uint32_t* index) {
    const F4::V a = load(&r[index[0]].x).v, b = load(&r[index[1]].x).v;
    const F4::V c = load(&r[index[2]].x).v, d = load(&r[index[3]].x).v;
    const F4::V ab_xy = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                cd_xy = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const F4::V ab_zw = __builtin_shufflevector(a, b, 2, 6, 3, 7),
                cd_zw = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    x = __builtin_shufflevector(ab_xy, cd_xy, 0, 1, 4, 5);
    y = __builtin_shufflevector(ab_xy, cd_xy, 2, 3, 6, 7);
    z = __builtin_shufflevector(ab_zw, cd_zw, 0, 1, 4, 5);
    w = __builtin_shufflevector(ab_zw, cd_zw, 2, 3, 6, 7);
  }
};

#else

struct F4 {
  float v[4];
  F4(float a = 0) : v{a, a, a, a} {}  // NOLINT(google-explicit-constructor): broadcasts constants
  F4(float a, float b, float c, float d) : v{a, b, c, d} {}
  float operator[](int k) const { return v[k]; }
};

template <class F>
F4 lanes(const F& f) {
  return {f(0), f(1), f(2), f(3)};
}
inline F4 operator+(F4 a, F4 b) {
  return lanes([&](int k) { return a[k] + b[k]; });
}
inline F4 operator-(F4 a, F4 b) {
  return lanes([&](int k) { return a[k] - b[k]; });
}
inline F4 operator*(F4 a, F4 b) {
  return lanes([&](int k) { return a[k] * b[k]; });
}
inline F4 operator/(F4 a, F4 b) {
  return lanes([&](int k) { return a[k] / b[k]; });
}
inline F4 larger(F4 a, F4 b) {
  return lanes([&](int k) { return a[k] > b[k] ? a[k] : b[k]; });
}
inline F4 root(F4 a) {
  return lanes([&](int k) { return std::sqrt(a[k]); });
}
inline F4 load(const float* p) {
  return {p[0], p[1], p[2], p[3]};
}
inline void store(float* p, F4 a) {
  for (int k = 0; k < 4; ++k) p[k] = a[k];
}
inline F4 gather(const float* p, const std::uint32_t* index) {
  return {p[index[0]], p[index[1]], p[index[2]], p[index[3]]};
}

struct Sum4 {
  double v[4] = {0, 0, 0, 0};
  void operator+=(F4 a) {
    for (int k = 0; k < 4; ++k) v[k] += a[k];
  }
  double total() const { return (v[0] + v[2]) + (v[1] + v[3]); }
};

struct Record4 {
  F4 x, y, z, w;
  Record4(const Record* r, const std::uint32_t* i)
      : x(r[i[0]].x, r[i[1]].x, r[i[2]].x, r[i[3]].x),
        y(r[i[0]].y, r[i[1]].y, r[i[2]].y, r[i[3]].y),
        z(r[i[0]].z, r[i[1]].z, r[i[2]].z, r[i[3]].z),
        w(r[i[0]].w, r[i[1]].w, r[i[2]].w, r[i[3]].w) {}
};

#endif

inline void operator+=(F4& a, F4 b) {
  a = a + b;
}
inline float total(F4 a) {
  return (a[0] + a[2]) + (a[1] + a[3]);
}

// The same names for scalars, so that kernels are written once.
inline double larger(double a, double b) {
  return a > b ? a : b;
}
inline double root(double a) {
  return std::sqrt(a);
}

}  // namespace oilskin::fluid
