/// Compiled with -mavx2. What this unit defines is in namespace avx2 or a template of a type there: the
/// linker must not give other units a function that needs AVX2 (test instruction_set_symbols).
#include "fluid/pairs/pair_kernels_avx2.h"

#include "core/simd_avx2.h"
#include "fluid/pairs/all_loops.h"

namespace oilskin::fluid {

namespace avx2 {

/// Byte k of order[bits]: which of eight lanes comes k-th if those with set bits come first.
struct Selection {
  alignas(64) std::uint8_t order[256][8];
};

constexpr Selection make_selection() {
  Selection s{};
  for (unsigned bits = 0; bits < 256; ++bits) {
    unsigned count = 0;
    for (unsigned k = 0; k < 8; ++k)
      if (bits >> k & 1) s.order[bits][count++] = static_cast<std::uint8_t>(k);
  }
  return s;
}

static constexpr Selection selection = make_selection();

struct Lanes {
  using F8 = simd::avx2::F8;
  using D4 = simd::avx2::D4;
  using Mask4 = simd::avx2::Mask4;
  using Sum8 = simd::avx2::Sum8;
  using Record8 = simd::avx2::Record8;

  static std::size_t select(std::uint32_t bits, const std::uint32_t* from, std::uint32_t* to) {
    const __m256i order =
        _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(selection.order[bits])));
    const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32(all, order));
    return static_cast<std::size_t>(__builtin_popcount(bits));
  }
};

static constexpr PairKernels kernels = kernels_of_lanes<Lanes>();

}  // namespace avx2

const PairKernels& avx2_pair_kernels() {
  return avx2::kernels;
}

}  // namespace oilskin::fluid
