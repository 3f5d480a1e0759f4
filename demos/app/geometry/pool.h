/// Water at rest in a cloth: where its surface should be, and how much of it is elsewhere.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::demo {

/// The horizontal surface of a given volume of water in a basin.
struct PoolSurface {
  double height = 0;    ///< along `up` [m]
  double area = 0;      ///< of the free surface [m²]
  bool in_rim = false;  ///< the basin holds the water: its lowest border is not below the surface
};

/// The cloth as it is at x_t1 counts as one basin, a height field over the horizontal plane. Taken from its
/// shape and the water's volume alone, not from where the water is: water that hangs high up does not lift
/// the level that it is held against. `up` has length 1; `volume` [m³].
PoolSurface pool_surface(const SurfaceMotion& cloth, const Vec3& up, double volume);

/// Where the water stands about the basin's deepest node: the 95 % quantile of the heights within `radius`
/// [m] of it, seen along `up`. Not finite when there is no water.
double level_in_middle(const SurfaceMotion& cloth, Span<const Vec3> positions, const Vec3& up, double radius);

/// The fraction of the positions that are higher than `height` along `up`.
double fraction_above(Span<const Vec3> positions, const Vec3& up, double height);

/// Σ ½ m v² [m²/s²] for particles of the masses `ratios`; empty: of mass 1.
double kinetic_energy_per_mass(Span<const Vec3> velocities, Span<const float> ratios = {});

/// sqrt(mean v²) of the particles inside a box [m/s]; not finite when there are none.
double rms_speed_within(Span<const Vec3> positions, Span<const Vec3> velocities, const Box& within);

}  // namespace oilskin::demo
