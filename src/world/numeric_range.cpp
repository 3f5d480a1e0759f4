#include "world/numeric_range.h"

#include "core/refuse.h"

namespace oilskin::world {

Status check_dt(double dt) {
  if (dt >= 1e-12 && dt <= 1e6) return {};
  return refuse("dt is ", dt, "; it must be 1e-12 … 1e6 s");
}

}  // namespace oilskin::world
