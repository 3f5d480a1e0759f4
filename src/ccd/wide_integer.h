/// Integers with a fixed number of 64-bit limbs: enough for coordinates of similar magnitude, and several
/// times faster than big integers. Internal to the module.
#pragma once

#include <cstdint>

#ifdef __SIZEOF_INT128__
#define OILSKIN_CCD_WIDE_INTEGERS

namespace oilskin::ccd::detail {

/// Two's complement, least significant limb first. A sum has the size of its terms: the caller ensures that
/// it does not overflow.
template <int N>
struct WideInteger {
  std::uint64_t limb[N];

  bool negative() const { return limb[N - 1] >> 63 != 0; }
  int sign() const {
    std::uint64_t any = 0;
    for (int i = 0; i < N; ++i) any |= limb[i];
    return negative() ? -1 : (any != 0 ? 1 : 0);
  }
};

__extension__ using DoubleLimb = unsigned __int128;

template <int N>
inline WideInteger<N> operator+(const WideInteger<N>& a, const WideInteger<N>& b) {
  WideInteger<N> sum;
  std::uint64_t carry = 0;
  for (int i = 0; i < N; ++i) {
    const DoubleLimb s = static_cast<DoubleLimb>(a.limb[i]) + b.limb[i] + carry;
    sum.limb[i] = static_cast<std::uint64_t>(s);
    carry = static_cast<std::uint64_t>(s >> 64);
  }
  return sum;
}

template <int N>
inline WideInteger<N> operator-(const WideInteger<N>& a, const WideInteger<N>& b) {
  WideInteger<N> difference;
  std::uint64_t borrow = 0;
  for (int i = 0; i < N; ++i) {
    const DoubleLimb d = static_cast<DoubleLimb>(a.limb[i]) - b.limb[i] - borrow;
    difference.limb[i] = static_cast<std::uint64_t>(d);
    borrow = static_cast<std::uint64_t>(d >> 64) & 1;
  }
  return difference;
}

/// Never overflows.
template <int N, int M>
inline WideInteger<N + M> operator*(const WideInteger<N>& a, const WideInteger<M>& b) {
  WideInteger<N + M> product{};
  for (int i = 0; i < N; ++i) {
    std::uint64_t carry = 0;
    for (int j = 0; j < M; ++j) {
      const DoubleLimb p = static_cast<DoubleLimb>(a.limb[i]) * b.limb[j] + product.limb[i + j] + carry;
      product.limb[i + j] = static_cast<std::uint64_t>(p);
      carry = static_cast<std::uint64_t>(p >> 64);
    }
    product.limb[i + M] = carry;
  }
  // Read as unsigned, a negative number is too large by 2^(64 count).
  const auto correct = [&product](const auto& factor, int count, int from, bool other_is_negative) {
    const std::uint64_t mask = other_is_negative ? ~std::uint64_t{0} : 0;
    std::uint64_t borrow = 0;
    for (int i = 0; i < count; ++i) {
      const DoubleLimb d = static_cast<DoubleLimb>(product.limb[from + i]) - (factor.limb[i] & mask) - borrow;
      product.limb[from + i] = static_cast<std::uint64_t>(d);
      borrow = static_cast<std::uint64_t>(d >> 64) & 1;
    }
  };
  correct(b, M, N, a.negative());
  correct(a, N, M, b.negative());
  return product;
}

/// ±mantissa 2^shift, which must fit.
inline WideInteger<2> wide_from(std::uint64_t mantissa, int shift, bool negative) {
  const DoubleLimb magnitude = static_cast<DoubleLimb>(mantissa) << shift;
  const DoubleLimb value = negative ? ~magnitude + 1 : magnitude;
  return {{static_cast<std::uint64_t>(value), static_cast<std::uint64_t>(value >> 64)}};
}

}  // namespace oilskin::ccd::detail

#endif
