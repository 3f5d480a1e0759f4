/// Names of the files of a frame.
#pragma once

#include <cstdio>
#include <string>

namespace oilskin::demo {

/// DIR/NAME_NNNN.SUFFIX
inline std::string frame_path(const std::string& directory, const std::string& name, int number,
                              const char* suffix) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "_%04d.", number);
  return directory + "/" + name + digits + suffix;
}

}  // namespace oilskin::demo
