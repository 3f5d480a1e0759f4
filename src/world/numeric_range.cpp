#include "world/numeric_range.h"

#include "core/refuse.h"

namespace oilskin::world {

bool is_in_range(const Vec3& v) {
  return (v.array().abs() < 1e15).all();
}

Status check_dt(double dt) {
  if (dt >= 1e-12 && dt <= 1e6) return {};
  return refuse("dt is ", dt, "; it must be 1e-12 … 1e6 s");
}

}  // namespace oilskin::world
