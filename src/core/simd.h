/// Four and eight floats at a time: with vector extensions of the compiler, or as plain arrays (define
/// OILSKIN_SCALAR). Both do the same IEEE operations in the same order, so they give the same bits.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#if defined(__has_builtin) && !defined(OILSKIN_SCALAR)
#if __has_builtin(__builtin_shufflevector) && __has_builtin(__builtin_convertvector)
#define OILSKIN_VECTOR_EXTENSIONS 1
#endif
#endif
#if defined(OILSKIN_VECTOR_EXTENSIONS) && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace oilskin::simd {

/// Four floats that are loaded together.
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
#if defined(__SSE2__)
// MAXPS is a > b ? a : b and MINPS is a < b ? a : b, for NaN and zeros too.
inline F4 larger(F4 a, F4 b) {
  return F4::V(_mm_max_ps(a.v, b.v));
}
inline F4 smaller(F4 a, F4 b) {
  return F4::V(_mm_min_ps(a.v, b.v));
}
inline F4 root(F4 a) {
  return F4::V(_mm_sqrt_ps(a.v));
}
#else
inline F4 larger(F4 a, F4 b) {
  return a.v > b.v ? a.v : b.v;
}
inline F4 smaller(F4 a, F4 b) {
  return a.v < b.v ? a.v : b.v;
}
inline F4 root(F4 a) {
  return F4::V{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
#endif

/// p is aligned to 16 bytes.
inline F4 load(const float* p) {
  return *reinterpret_cast<const F4::V*>(p);
}
inline void store(float* p, F4 a) {
  *reinterpret_cast<F4::V*>(p) = a.v;
}
inline F4 gather(const float* p, const std::uint32_t* index) {
  return F4::V{p[index[0]], p[index[1]], p[index[2]], p[index[3]]};
}

/// Sums floats in double, so that antisymmetric terms cancel to 1e-16.
struct Sum4 {
  using D = double __attribute__((vector_size(16)));
  D low{}, high{};
  void operator+=(F4 a) {
    low += __builtin_convertvector(__builtin_shufflevector(a.v, a.v, 0, 1), D);
    high += __builtin_convertvector(__builtin_shufflevector(a.v, a.v, 2, 3), D);
  }
  /// Adds a b, which is exact in double.
  void add_product(F4 a, F4 b) {
    low += __builtin_convertvector(__builtin_shufflevector(a.v, a.v, 0, 1), D) *
           __builtin_convertvector(__builtin_shufflevector(b.v, b.v, 0, 1), D);
    high += __builtin_convertvector(__builtin_shufflevector(a.v, a.v, 2, 3), D) *
            __builtin_convertvector(__builtin_shufflevector(b.v, b.v, 2, 3), D);
  }
  double total() const { return (low[0] + high[0]) + (low[1] + high[1]); }
  Sum4 operator+(const Sum4& o) const { return {low + o.low, high + o.high}; }
};

/// Four records, transposed: x[k] is that of record index[k], or of the k-th from r on.
struct Record4 {
  F4 x, y, z, w;
  Record4(const Record* r, const std::uint32_t* index)
      : Record4(r[index[0]], r[index[1]], r[index[2]], r[index[3]]) {}
  explicit Record4(const Record* r) : Record4(r[0], r[1], r[2], r[3]) {}

 private:
  Record4(const Record& r0, const Record& r1, const Record& r2, const Record& r3) {
    const F4::V a = load(&r0.x).v, b = load(&r1.x).v;
    const F4::V c = load(&r2.x).v, d = load(&r3.x).v;
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
inline F4 smaller(F4 a, F4 b) {
  return lanes([&](int k) { return a[k] < b[k] ? a[k] : b[k]; });
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
  void add_product(F4 a, F4 b) {
    for (int k = 0; k < 4; ++k) v[k] += static_cast<double>(a[k]) * static_cast<double>(b[k]);
  }
  double total() const { return (v[0] + v[2]) + (v[1] + v[3]); }
  Sum4 operator+(const Sum4& o) const {
    return {{v[0] + o.v[0], v[1] + o.v[1], v[2] + o.v[2], v[3] + o.v[3]}};
  }
};

struct Record4 {
  F4 x, y, z, w;
  Record4(const Record* r, const std::uint32_t* i)
      : x(r[i[0]].x, r[i[1]].x, r[i[2]].x, r[i[3]].x),
        y(r[i[0]].y, r[i[1]].y, r[i[2]].y, r[i[3]].y),
        z(r[i[0]].z, r[i[1]].z, r[i[2]].z, r[i[3]].z),
        w(r[i[0]].w, r[i[1]].w, r[i[2]].w, r[i[3]].w) {}
  explicit Record4(const Record* r)
      : x(r[0].x, r[1].x, r[2].x, r[3].x),
        y(r[0].y, r[1].y, r[2].y, r[3].y),
        z(r[0].z, r[1].z, r[2].z, r[3].z),
        w(r[0].w, r[1].w, r[2].w, r[3].w) {}
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

/// Eight floats as two F4.
struct F8 {
  F4 low, high;
  F8() = default;
  F8(F4 l, F4 h) : low(l), high(h) {}
  F8(float a) : low(a), high(a) {}  // NOLINT(google-explicit-constructor): broadcasts constants

  /// No alignment is needed.
  static F8 load(const float* p) {
    F8 a;
    std::memcpy(static_cast<void*>(&a), p, sizeof a);
    return a;
  }
  static F8 gather(const float* p, const std::uint32_t* index) {
    return {simd::gather(p, index), simd::gather(p, index + 4)};
  }
  void store(float* p) const { std::memcpy(p, static_cast<const void*>(this), sizeof *this); }
};
static_assert(sizeof(F8) == 8 * sizeof(float), "eight floats, nothing else");

inline F8 operator+(const F8& a, const F8& b) {
  return {a.low + b.low, a.high + b.high};
}
inline F8 operator-(const F8& a, const F8& b) {
  return {a.low - b.low, a.high - b.high};
}
inline F8 operator*(const F8& a, const F8& b) {
  return {a.low * b.low, a.high * b.high};
}
inline F8 operator/(const F8& a, const F8& b) {
  return {a.low / b.low, a.high / b.high};
}
inline void operator+=(F8& a, const F8& b) {
  a = a + b;
}
inline F8 root(const F8& a) {
  return {root(a.low), root(a.high)};
}
inline float total(const F8& a) {
  return total(a.low + a.high);
}
inline F8 larger(const F8& a, const F8& b) {
  return {larger(a.low, b.low), larger(a.high, b.high)};
}
inline F8 smaller(const F8& a, const F8& b) {
  return {smaller(a.low, b.low), smaller(a.high, b.high)};
}
/// 0 where a is not positive.
inline F8 positive_part(const F8& a) {
  return larger(a, 0.0f);
}

/// `a` where `x` is positive, else `b`.
inline F8 choose_positive(const F8& x, const F8& a, const F8& b) {
#if defined(OILSKIN_VECTOR_EXTENSIONS) && defined(__SSE2__)
  const auto half = [](F4 y, F4 c, F4 d) {
    const __m128 mask = _mm_cmpgt_ps(y.v, _mm_setzero_ps());
    return F4(F4::V(_mm_or_ps(_mm_and_ps(mask, c.v), _mm_andnot_ps(mask, d.v))));
  };
  return {half(x.low, a.low, b.low), half(x.high, a.high, b.high)};
#else
  float s[8], p[8], q[8];
  x.store(s);
  a.store(p);
  b.store(q);
  for (int k = 0; k < 8; ++k) p[k] = s[k] > 0 ? p[k] : q[k];
  return F8::load(p);
#endif
}

/// Bit k: a[k] > b[k].
inline std::uint32_t greater_mask(const F8& a, const F8& b) {
#if defined(OILSKIN_VECTOR_EXTENSIONS) && defined(__SSE2__)
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpgt_ps(a.low.v, b.low.v)) |
                                    _mm_movemask_ps(_mm_cmpgt_ps(a.high.v, b.high.v)) << 4);
#else
  float x[8], y[8];
  a.store(x);
  b.store(y);
  std::uint32_t bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<std::uint32_t>(x[k] > y[k]) << k;
  return bits;
#endif
}

/// Eight sums of floats in double, so that antisymmetric terms cancel to 1e-16.
struct Sum8 {
  Sum4 low, high;
  void operator+=(const F8& a) {
    low += a.low;
    high += a.high;
  }
  /// Adds a b, which is exact in double.
  void add_product(const F8& a, const F8& b) {
    low.add_product(a.low, b.low);
    high.add_product(a.high, b.high);
  }
  double total() const { return (low + high).total(); }
};

/// Eight records, transposed: x[k] is that of record index[k], or of the k-th from r on.
struct Record8 {
  F8 x, y, z, w;
  Record8(const Record* r, const std::uint32_t* index) : Record8(Record4(r, index), Record4(r, index + 4)) {}
  explicit Record8(const Record* r) : Record8(Record4(r), Record4(r + 4)) {}

 private:
  Record8(const Record4& a, const Record4& b) : x(a.x, b.x), y(a.y, b.y), z(a.z, b.z), w(a.w, b.w) {}
};

/// Sets the elements of which bits are set to 0.
inline F8 cleared(const F8& a, std::uint32_t bits) {
  float x[8];
  a.store(x);
  for (; bits != 0; bits &= bits - 1) x[__builtin_ctz(bits)] = 0;
  return F8::load(x);
}

}  // namespace oilskin::simd
