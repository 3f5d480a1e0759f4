#include "fluid/pairs/pair_kernels.h"

#include <array>
#include <atomic>

#include "core/assert.h"
#include "core/simd_double.h"
#include "fluid/pairs/all_loops.h"
#include "fluid/pairs/pair_kernels_avx2.h"
#include "fluid/pairs/pair_kernels_avx512.h"

namespace oilskin::fluid {

namespace {

struct BaselineLanes {
  using F8 = simd::F8;
  using D4 = simd::D4;
  using Mask4 = simd::Mask4;
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

constexpr PairKernels baseline = kernels_of_lanes<BaselineLanes>();

struct Available {
  InstructionSet set;
  PairKernels kernels;
};

PairKernels kernels_of([[maybe_unused]] InstructionSet set) {
  PairKernels kernels = baseline;
#if defined(OILSKIN_AVX2)
  if (set != InstructionSet::baseline) kernels = avx2_pair_kernels();
#endif
#if defined(OILSKIN_AVX512)
  if (set == InstructionSet::avx512) kernels.near = avx512_near;
#endif
  return kernels;
}

const Available& kept(InstructionSet set) {
  static const std::array<Available, 3> all = {
      {{InstructionSet::baseline, kernels_of(InstructionSet::baseline)},
       {InstructionSet::avx2, kernels_of(InstructionSet::avx2)},
       {InstructionSet::avx512, kernels_of(InstructionSet::avx512)}}};
  return all[static_cast<std::size_t>(set)];
}

/// Null: not chosen yet.
std::atomic<const Available*> in_use{nullptr};

const Available& chosen() {
  const Available* now = in_use.load(std::memory_order_acquire);
  if (now) return *now;
  now = &kept(InstructionSet::baseline);
  for (const InstructionSet set : all_instruction_sets)
    if (is_available(set)) now = &kept(set);
  in_use.store(now, std::memory_order_release);
  return *now;
}

}  // namespace

bool is_available(InstructionSet set) {
  switch (set) {
#if defined(OILSKIN_AVX2)
    case InstructionSet::avx2:
      return __builtin_cpu_supports("avx2") != 0;
#endif
#if defined(OILSKIN_AVX2) && defined(OILSKIN_AVX512)
    case InstructionSet::avx512:
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("avx512f") != 0;
#endif
    default:
      return set == InstructionSet::baseline;
  }
}

const PairKernels& pair_kernels() {
  return chosen().kernels;
}

InstructionSet instruction_set() {
  return chosen().set;
}

void use(InstructionSet set) {
  OILSKIN_ASSERT(is_available(set));
  in_use.store(&kept(set), std::memory_order_release);
}

}  // namespace oilskin::fluid
