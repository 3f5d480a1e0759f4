/// Ranges, and refusals with a reason.
#pragma once

#include <cmath>
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

inline Status check_point(const char* field, const Vec3& x) {
  return x.allFinite() ? Status() : refuse_value(field, x.transpose(), "finite");
}

inline Status check_box(const Box& box) {
  if (Status s = check_point("box.min", box.min); !s.ok()) return s;
  if (Status s = check_point("box.max", box.max); !s.ok()) return s;
  return (box.min.array() <= box.max.array()).all()
             ? Status()
             : refuse_value("box.min", box.min.transpose(), "at most box.max on every axis");
}

inline Status check_ball(const Vec3& center, double radius) {
  if (Status s = check_point("center", center); !s.ok()) return s;
  return radius >= 0 && std::isfinite(radius) ? Status() : refuse_value("radius", radius, "finite and ≥ 0 m");
}

}  // namespace oilskin
