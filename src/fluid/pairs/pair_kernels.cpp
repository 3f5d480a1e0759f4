#include "fluid/pairs/pair_kernels.h"

#include <atomic>

#include "core/assert.h"
#include "fluid/pairs/pair_kernels_avx2.h"
#include "fluid/pairs/pair_loops.h"

namespace oilskin::fluid {

namespace {

struct BaselineLanes {
  using F8 = simd::F8;
  using Sum8 = simd::Sum8;
  using Record8 = simd::Record8;

  /// Copies those of eight indices whose bits are set. Branch-free: writes always, advances for set bits.
  static std::size_t select(std::uint32_t bits, const std::uint32_t* from, std::uint32_t* to) {
    std::size_t count = 0;
    for (int k = 0; k < 8; ++k) {
      to[count] = from[k];
      count += bits >> k & 1;
    }
    return count;
  }
};

constexpr PairKernels baseline = PairLoops<BaselineLanes>::kernels();

const PairKernels& kernels_of(InstructionSet set) {
#if defined(OILSKIN_AVX2)
  if (set == InstructionSet::avx2) return avx2_pair_kernels();
#endif
  OILSKIN_ASSERT(set == InstructionSet::baseline);
  return baseline;
}

/// Null: not chosen yet.
std::atomic<const PairKernels*> in_use{nullptr};

}  // namespace

bool is_available(InstructionSet set) {
  if (set == InstructionSet::baseline) return true;
#if defined(OILSKIN_AVX2)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

const PairKernels& pair_kernels() {
  const PairKernels* kernels = in_use.load(std::memory_order_acquire);
  if (kernels) return *kernels;
  use(is_available(InstructionSet::avx2) ? InstructionSet::avx2 : InstructionSet::baseline);
  return *in_use.load(std::memory_order_acquire);
}

InstructionSet instruction_set() {
  return &pair_kernels() == &baseline ? InstructionSet::baseline : InstructionSet::avx2;
}

void use(InstructionSet set) {
  OILSKIN_ASSERT(is_available(set));
  in_use.store(&kernels_of(set), std::memory_order_release);
}

}  // namespace oilskin::fluid
