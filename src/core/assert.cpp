#include "core/assert.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace oilskin {

namespace {
std::atomic<AssertHandler> current_handler{nullptr};
}

void set_assert_handler(AssertHandler handler) {
  current_handler = handler;
}

namespace detail {
void assert_failed(const char* expression, const char* file, int line) {
  if (AssertHandler handler = current_handler.load()) {
    handler(expression, file, line);
    return;
  }
  std::fprintf(stderr, "oilskin: assertion failed: %s (%s:%d)\n", expression, file, line);
  std::abort();
}
}  // namespace detail

}  // namespace oilskin
