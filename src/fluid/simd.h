/// The names of core/simd.h for the pair loops.
#pragma once

#include "core/simd.h"

namespace oilskin::fluid {

using simd::F4;
using simd::gather;
using simd::larger;
using simd::load;
using simd::Record;
using simd::Record4;
using simd::root;
using simd::store;
using simd::Sum4;
using simd::total;

}  // namespace oilskin::fluid
