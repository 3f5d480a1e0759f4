#pragma once

#include "fluid/pairs/pair_kernels.h"

namespace oilskin::fluid {

/// PairKernels::near for machines that have AVX-512; only where OILSKIN_AVX512 is defined.
std::size_t avx512_near(const Candidates& candidates, const Record& p, std::uint32_t* out);

}  // namespace oilskin::fluid
