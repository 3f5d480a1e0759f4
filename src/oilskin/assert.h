/// @file
/// What happens when an assertion of the library fails: a mistake of the calling program or a broken
/// invariant. Assertions are compiled in if the library is built without NDEBUG or with OILSKIN_ASSERTS.
#pragma once

namespace oilskin {

/// Is called on the thread on which the assertion failed. If it returns, the library goes on with the state
/// that the assertion rejects.
using AssertHandler = void (*)(const char* expression, const char* file, int line);

/// Replaces the default handler, which prints the expression and aborts. Null restores the default.
/// Thread-safe.
void set_assert_handler(AssertHandler handler);

}  // namespace oilskin
