#include "world/intake.h"

namespace oilskin::world {

bool is_sound(const Vec3& v) {
  return (v.array().abs() < 1e15).all();
}

}  // namespace oilskin::world
