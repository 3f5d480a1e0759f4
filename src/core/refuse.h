/// Ranges, and refusals with a reason.
#pragma once

#include <sstream>

#include "oilskin/types.h"

namespace oilskin {

/// Not where x is not a number.
inline bool within(double x, double low, double high) {
  return x >= low && x <= high;
}

/// The reason is the parts, printed one after the other.
template <class... Parts>
Status refuse(const Parts&... parts) {
  std::ostringstream reason;
  (reason << ... << parts);
  return Status::refused(reason.str());
}

/// "FIELD is VALUE; it must be RANGE".
template <class T>
Status refuse_value(const char* field, const T& value, const char* range) {
  return refuse(field, " is ", value, "; it must be ", range);
}

}  // namespace oilskin
