// Ends the program as "skipped" before any code that was compiled with AVX2 runs, static initialisers
// included.
#include <unistd.h>

namespace {
__attribute__((constructor(101))) void skip_without_avx2() {
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2")) _exit(77);
}
}  // namespace
