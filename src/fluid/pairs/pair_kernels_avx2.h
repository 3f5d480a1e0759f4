#pragma once

#include "fluid/pairs/pair_kernels.h"

namespace oilskin::fluid {

/// Only where OILSKIN_AVX2 is defined, and for machines that have AVX2.
const PairKernels& avx2_pair_kernels();

}  // namespace oilskin::fluid
