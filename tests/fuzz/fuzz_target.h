/// What each fuzz target provides. The fuzzer links it with libFuzzer, the suite with replay_test.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "oilskin/types.h"

/// Never returns anything but 0; aborts where a promise is broken.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace oilskin::fuzz {

/// Inputs to begin with: valid ones, so that mutations get past the first checks.
std::vector<std::vector<std::uint8_t>> seeds();

/// Prints and aborts, in any build.
[[noreturn]] void broken(const std::string& promise);
inline void expect(bool holds, const char* promise) {
  if (!holds) broken(promise);
}

}  // namespace oilskin::fuzz
