#include "fuzz/fuzz_target.h"

#include <cstdio>
#include <cstdlib>

namespace oilskin::fuzz {

void broken(const std::string& promise) {
  std::fprintf(stderr, "broken: %s\n", promise.c_str());
  std::abort();
}

}  // namespace oilskin::fuzz
