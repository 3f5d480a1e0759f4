#include "world/numeric_range.h"

namespace oilskin::world {

bool is_in_range(const Vec3& v) {
  return (v.array().abs() < 1e15).all();
}

}  // namespace oilskin::world
