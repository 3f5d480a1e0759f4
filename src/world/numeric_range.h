/// The range of positions, velocities and lengths that a step accepts.
#pragma once

#include "fluid/particles.h"

namespace oilskin::world {

/// Finite, and so small that products of six values do not overflow in the continuous test.
inline bool is_in_range(const Vec3& v) {
  return (v.array().abs() < 1e15).all();
}

/// The numbers of a particle. A step removes one that is not.
inline bool is_in_range(const fluid::Particles& particles, std::size_t i) {
  return is_in_range(particles.position[i]) && is_in_range(particles.velocity[i]) &&
         is_in_range(particles.motion[i]);
}

/// Refuses a step that is not 1e-12 … 1e6 s.
Status check_dt(double dt);

}  // namespace oilskin::world
