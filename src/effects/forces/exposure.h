/// How much of a particle is at the free surface.
#pragma once

#include "oilskin/effect.h"

namespace oilskin::effects {

/// The area that a particle shows to the air [m²].
struct Exposure {
  double facing = 0;  ///< A_⊥ (G.5)
  double whole = 0;   ///< A (G.5)
};

/// `wind`: its direction, unit.
Exposure exposure(const EffectForces& f, std::size_t i, const Vec3& wind);

/// The part of a particle that nothing shelters on a side, 0 … 1 (G.3). `side`: unit.
double exposed_part(const EffectForces& f, std::size_t i, const Vec3& side);

/// The slope of the water's kernel sum, times H, towards the air.
Vec3 outward_slope(const EffectForces& f, std::size_t i);

/// Slopes of the disorder of particles within the fluid are smaller than the first; from the second on there
/// is a surface. The slope of the first layer of a plane surface is 1 at H = 2 dx.
constexpr double no_surface = 0.3, clear_surface = 0.6;

}  // namespace oilskin::effects
