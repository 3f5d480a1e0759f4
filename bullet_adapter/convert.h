/// Conversions between Bullet's types and the library's.
#pragma once

#include <LinearMath/btVector3.h>

#include "oilskin/surface_motion.h"

namespace oilskin::bullet {

/// The type in which Bullet stores positions.
constexpr Storage bt_storage = sizeof(btScalar) == sizeof(float) ? Storage::float32 : Storage::float64;

inline Vec3 to_vec3(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

/// Rounds to btScalar; exact for stored numbers.
inline btVector3 to_bt(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

/// The velocity of a prescribed node from its motion since the last coupling (Bullet reports 0 for a pin that
/// was moved by hand). Zero at attach and after a teleport.
inline Vec3 prescribed_velocity(const SurfaceMotion& motion, std::size_t node, double dt) {
  if (!(dt > 0) || node >= motion.x_t0.size()) return Vec3::Zero();
  return (motion.x_t1[node] - motion.x_t0[node]) / dt;
}

}  // namespace oilskin::bullet
