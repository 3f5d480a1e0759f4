/// Compiled with -mavx512f: what holds for pair_kernels_avx2.cpp holds here.
#include "fluid/pairs/pair_kernels_avx512.h"

#include <immintrin.h>

namespace oilskin::fluid {

std::size_t avx512_near(const Candidates& c, const Record& p, std::uint32_t* out) {
  const __m512 px = _mm512_set1_ps(p.x), py = _mm512_set1_ps(p.y), pz = _mm512_set1_ps(p.z);
  const __m512 one = _mm512_set1_ps(1.0f);
  std::size_t found = 0;
  for (std::size_t k = 0; k < c.count; k += 16) {
    const __m512 dx = _mm512_sub_ps(_mm512_load_ps(c.x + k), px);
    const __m512 dy = _mm512_sub_ps(_mm512_load_ps(c.y + k), py);
    const __m512 dz = _mm512_sub_ps(_mm512_load_ps(c.z + k), pz);
    // Separate products and sums, as in the other versions: a fused one is rounded once.
    const __m512 xy = _mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy));
    const __m512 r2 = _mm512_add_ps(xy, _mm512_mul_ps(dz, dz));
    const __mmask16 near = _mm512_cmp_ps_mask(one, r2, _CMP_GT_OQ);
    // A compressing store is slow on Zen 4; compressing in a register is not.
    const __m512i particle = _mm512_load_si512(c.particle + k);
    _mm512_storeu_si512(out + found, _mm512_maskz_compress_epi32(near, particle));
    found += static_cast<std::size_t>(__builtin_popcount(near));
  }
  return found;
}

}  // namespace oilskin::fluid
