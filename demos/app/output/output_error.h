#pragma once

#include <stdexcept>

namespace oilskin::demo {

/// Something could not be written although it began well: the disk is full, or the reader left.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace oilskin::demo
