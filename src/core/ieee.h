/// Checks the arithmetic that the error bounds of the predicates, and reproducible results, require. Include
/// it where predicates are computed.
#pragma once

#include <cfloat>
#include <limits>

static_assert(std::numeric_limits<double>::is_iec559, "the predicates need IEEE 754 doubles");
#if defined(__FAST_MATH__)
#error "the predicates need strict IEEE arithmetic: compile without -ffast-math"
#endif
#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD != 0
#error \
    "the predicates need every operation rounded to its own type: compile for SSE2 (-msse2 -mfpmath=sse), not x87"
#endif
