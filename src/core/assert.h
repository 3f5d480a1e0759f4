/// Assertions for misuse by the programmer and for broken invariants. Alive in every build but those that
/// define NDEBUG and not OILSKIN_ASSERTS; a host can route them.
#pragma once

namespace oilskin {

using AssertHandler = void (*)(const char* expression, const char* file, int line);

/// The default prints and aborts. Null restores it.
void set_assert_handler(AssertHandler handler);

namespace detail {
void assert_failed(const char* expression, const char* file, int line);
}

}  // namespace oilskin

#if !defined(NDEBUG) || defined(OILSKIN_ASSERTS)
#define OILSKIN_ASSERT(e) \
  ((e) ? static_cast<void>(0) : ::oilskin::detail::assert_failed(#e, __FILE__, __LINE__))
#else
#define OILSKIN_ASSERT(e) static_cast<void>(true || (e))  // compiled, never evaluated
#endif
