/// Integers of any length in a memory block of fixed size: exact arithmetic without allocation. Internal to
/// the module.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ccd/wide_integer.h"

namespace oilskin::ccd::detail {

#ifdef __SIZEOF_INT128__
using Limb = std::uint64_t;
__extension__ using WideLimb = unsigned __int128;
#else
using Limb = std::uint32_t;
using WideLimb = std::uint64_t;
#endif
constexpr int limb_bits = 8 * sizeof(Limb);

/// Sign and magnitude, least significant limb first, without leading zeros. The limbs lie in a Workspace.
struct BigInteger {
  const Limb* limbs = nullptr;
  int size = 0;
  int sign = 0;
};

inline BigInteger negated(const BigInteger& a) {
  return {a.limbs, a.size, -a.sign};
}

/// −1, 0 or 1 if |a| is less than, equal to or greater than |b|.
int compare_magnitudes(const BigInteger& a, const BigInteger& b);

/// The number m 2^exponent with 0.5 ≤ |m| < 1 (or 0), within 2⁻⁵⁰ relative.
struct Scaled {
  double mantissa = 0;
  int exponent = 0;
};
Scaled approximation(const BigInteger& a);

/// x 2^exponent: std::ldexp, faster.
double scaled(double x, int exponent);

/// |x| = mantissa 2^exponent with an odd mantissa, for finite x; or no mantissa, for 0.
struct Decomposed {
  std::uint64_t mantissa = 0;
  int exponent = 0;
};
Decomposed decompose(double x);

/// Stores results one behind the other. Once the block is full, results are zero and exhausted() is true:
/// callers that use a sign must check it.
class Workspace {
 public:
  /// Frees on destruction what was stored during its lifetime.
  class Scope {
   public:
    explicit Scope(Workspace* workspace) : workspace_(workspace), used_(workspace->used_) {
      ++workspace_->scopes_;
    }
    ~Scope() {
      workspace_->used_ = used_;
      --workspace_->scopes_;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Workspace* workspace_;
    std::size_t used_;
  };

  Workspace() {}  // NOLINT: the block stays uninitialised, which saves the time to clear 192 KiB
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  bool exhausted() const { return exhausted_; }
  bool in_scope() const { return scopes_ > 0; }

  BigInteger small(int value);
  /// x / 2^exponent, for finite x and an exponent not above that of decompose(x).
  BigInteger from_double(double x, int exponent);
#ifdef OILSKIN_CCD_WIDE_INTEGERS
  template <int N>
  BigInteger from_wide(const WideInteger<N>& a) {
    return from_wide(a.limb, N);
  }
#endif
  BigInteger sum(const BigInteger& a, const BigInteger& b);
  BigInteger difference(const BigInteger& a, const BigInteger& b) {
    return sum(a, negated(b));
  }
  BigInteger product(const BigInteger& a, const BigInteger& b);

 private:
  /// Enough limbs for the exact test of any finite coordinates; coordinates of similar magnitude need 1,000.
  static constexpr std::size_t capacity = (std::size_t{24576} * 64) / limb_bits;

#ifdef OILSKIN_CCD_WIDE_INTEGERS
  BigInteger from_wide(const std::uint64_t* limbs, int count);
#endif
  Limb* reserve(int size);
  BigInteger keep(Limb* limbs, int size, int sign);

  std::size_t used_ = 0;
  int scopes_ = 0;
  bool exhausted_ = false;
  Limb memory_[capacity];
};

}  // namespace oilskin::ccd::detail
