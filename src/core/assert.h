/// The macro that the library asserts with.
#pragma once

#include "oilskin/assert.h"

namespace oilskin::detail {
// A handler may return, but what holds after it is not worth analysing.
#ifdef __clang_analyzer__
[[noreturn]]
#endif
void assert_failed(const char* expression, const char* file, int line);
}  // namespace oilskin::detail

#if !defined(NDEBUG) || defined(OILSKIN_ASSERTS)
#define OILSKIN_ASSERT(e) \
  ((e) ? static_cast<void>(0) : ::oilskin::detail::assert_failed(#e, __FILE__, __LINE__))
#else
#define OILSKIN_ASSERT(e) static_cast<void>(true || (e))  // compiled, never evaluated
#endif
