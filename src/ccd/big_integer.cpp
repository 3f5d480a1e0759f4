#include "ccd/big_integer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/assert.h"

namespace oilskin::ccd::detail {
namespace {

int trailing_zeros(std::uint64_t x) {
#ifdef __GNUC__
  return __builtin_ctzll(x);
#else
  return std::ilogb(static_cast<double>(x & (~x + 1)));
#endif
}

/// The e with 2^(e−1) ≤ x < 2^e, for positive x of normal size.
int exponent_of(double x) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return static_cast<int>(bits >> 52) - 1022;
}

/// larger + smaller, by magnitude; returns the carry.
Limb add(const BigInteger& larger, const BigInteger& smaller, Limb* out) {
  WideLimb carry = 0;
  for (int i = 0; i < smaller.size; ++i) {
    carry += static_cast<WideLimb>(larger.limbs[i]) + smaller.limbs[i];
    out[i] = static_cast<Limb>(carry);
    carry >>= limb_bits;
  }
  for (int i = smaller.size; i < larger.size; ++i) {
    carry += larger.limbs[i];
    out[i] = static_cast<Limb>(carry);
    carry >>= limb_bits;
  }
  return static_cast<Limb>(carry);
}

/// larger − smaller, by magnitude.
void subtract(const BigInteger& larger, const BigInteger& smaller, Limb* out) {
  Limb borrow = 0;
  for (int i = 0; i < larger.size; ++i) {
    const WideLimb taken = static_cast<WideLimb>(i < smaller.size ? smaller.limbs[i] : 0) + borrow;
    const WideLimb have = larger.limbs[i];
    borrow = have < taken ? 1 : 0;
    out[i] = static_cast<Limb>(have - taken);
  }
  OILSKIN_ASSERT(borrow == 0);
}

}  // namespace

double scaled(double x, int exponent) {
  if (exponent < -1022 || exponent > 1023) return std::ldexp(x, exponent);
  const std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52;
  double power = 0;
  std::memcpy(&power, &bits, sizeof power);
  return x * power;
}

int compare_magnitudes(const BigInteger& a, const BigInteger& b) {
  if (a.size != b.size) return a.size < b.size ? -1 : 1;
  for (int i = a.size - 1; i >= 0; --i) {
    if (a.limbs[i] != b.limbs[i]) return a.limbs[i] < b.limbs[i] ? -1 : 1;
  }
  return 0;
}

Scaled approximation(const BigInteger& a) {
  if (a.sign == 0) return {};
  // The leading limb may be as small as 1: with 64 bits behind it the relative truncation error is below
  // 2⁻⁶⁴. At most five roundings.
  constexpr int leading_limbs = 1 + 64 / limb_bits;
  constexpr double limb_base = 2.0 * (Limb{1} << (limb_bits - 1));
  double leading = 0;
  for (int i = 1; i <= leading_limbs; ++i) {
    leading = leading * limb_base + (i <= a.size ? static_cast<double>(a.limbs[a.size - i]) : 0.0);
  }
  const int exponent = exponent_of(leading);
  return {a.sign * scaled(leading, -exponent), exponent + limb_bits * (a.size - leading_limbs)};
}

Decomposed decompose(double x) {
  static_assert(std::numeric_limits<double>::is_iec559 && sizeof(double) == 8,
                "decompose reads the bits of IEEE doubles");
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
  const int biased = static_cast<int>((bits >> 52) & 0x7ff);
  OILSKIN_ASSERT(biased != 0x7ff);
  const std::uint64_t mantissa = biased == 0 ? fraction : fraction | (std::uint64_t{1} << 52);
  if (mantissa == 0) return {};
  const int zeros = trailing_zeros(mantissa);
  return {mantissa >> zeros, (biased == 0 ? -1074 : biased - 1075) + zeros};
}

Limb* Workspace::reserve(int size) {
  OILSKIN_ASSERT(size > 0);
  if (exhausted_ || used_ + static_cast<std::size_t>(size) > capacity) {
    exhausted_ = true;
    return nullptr;
  }
  return memory_ + used_;
}

BigInteger Workspace::keep(Limb* limbs, int size, int sign) {
  while (size > 0 && limbs[size - 1] == 0) --size;
  OILSKIN_ASSERT(size == 0 || sign != 0);
  used_ += static_cast<std::size_t>(size);
  return {limbs, size, size == 0 ? 0 : sign};
}

BigInteger Workspace::small(int value) {
  Limb* out = reserve(1);
  if (out == nullptr) return {};
  out[0] = static_cast<Limb>(std::abs(value));
  return keep(out, 1, value < 0 ? -1 : 1);
}

BigInteger Workspace::from_double(double x, int exponent) {
  if (x == 0) return {};
  const Decomposed parts = decompose(x);
  std::uint64_t bits = parts.mantissa;
  const int shift = parts.exponent - exponent;
  OILSKIN_ASSERT(shift >= 0);
  const int zero_limbs = shift / limb_bits, size = zero_limbs + 1 + 64 / limb_bits;
  Limb* out = reserve(size);
  if (out == nullptr) return {};
  std::fill(out, out + size, Limb{0});
  // Limb by limb, since a shift by the full width of a type is undefined.
  WideLimb carry = 0;
  for (int i = zero_limbs; i < size; ++i) {
    carry += static_cast<WideLimb>(static_cast<Limb>(bits)) << (shift % limb_bits);
    out[i] = static_cast<Limb>(carry);
    carry >>= limb_bits;
    bits = limb_bits == 64 ? 0 : bits >> (limb_bits % 64);
  }
  return keep(out, size, x < 0 ? -1 : 1);
}

#ifdef OILSKIN_CCD_WIDE_INTEGERS
BigInteger Workspace::from_wide(const std::uint64_t* limbs, int count) {
  Limb* out = reserve(count);
  if (out == nullptr) return {};
  const bool negative = limbs[count - 1] >> 63 != 0;
  std::uint64_t carry = negative ? 1 : 0;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t limb = negative ? ~limbs[i] : limbs[i];
    out[i] = limb + carry;
    carry = out[i] < carry ? 1 : 0;
  }
  return keep(out, count, negative ? -1 : 1);
}
#endif

BigInteger Workspace::sum(const BigInteger& a, const BigInteger& b) {
  if (a.sign == 0) return b;
  if (b.sign == 0) return a;
  const int order = compare_magnitudes(a, b);
  const BigInteger &larger = order < 0 ? b : a, &smaller = order < 0 ? a : b;
  if (order == 0 && a.sign != b.sign) return {};
  Limb* out = reserve(larger.size + 1);
  if (out == nullptr) return {};
  out[larger.size] = 0;
  if (a.sign == b.sign) {
    out[larger.size] = add(larger, smaller, out);
  } else {
    subtract(larger, smaller, out);
  }
  return keep(out, larger.size + 1, larger.sign);
}

BigInteger Workspace::product(const BigInteger& a, const BigInteger& b) {
  if (a.sign == 0 || b.sign == 0) return {};
  const int size = a.size + b.size;
  Limb* out = reserve(size);
  if (out == nullptr) return {};
  WideLimb carry = 0;
  for (int j = 0; j < b.size; ++j) {
    carry += static_cast<WideLimb>(a.limbs[0]) * b.limbs[j];
    out[j] = static_cast<Limb>(carry);
    carry >>= limb_bits;
  }
  out[b.size] = static_cast<Limb>(carry);
  for (int i = 1; i < a.size; ++i) {
    const WideLimb factor = a.limbs[i];
    carry = 0;
    if (factor != 0) {  // numbers of very different magnitudes have many zero limbs
      for (int j = 0; j < b.size; ++j) {
        carry += factor * b.limbs[j] + out[i + j];
        out[i + j] = static_cast<Limb>(carry);
        carry >>= limb_bits;
      }
    }
    out[i + b.size] = static_cast<Limb>(carry);
  }
  return keep(out, size, a.sign * b.sign);
}

}  // namespace oilskin::ccd::detail
