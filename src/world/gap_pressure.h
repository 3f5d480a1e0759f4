/// Water below rigid bodies that stand on something: the pressure in gaps that no particle enters
/// (docs/theory/boundary.md, section 11).
#pragma once

#include "contact/surface_geometry.h"
#include "core/parallel.h"
#include "fluid/boundary/wall_impulse.h"
#include "oilskin/surface_motion.h"

namespace oilskin::world {

/// The particles at the start of an interval.
struct GapWater {
  Span<const Vec3> position;
  Span<const double> pressure;           ///< [Pa]
  Span<const fluid::WallImpulse> given;  ///< to particles by solid bodies
  double spacing = 0;                    ///< [m]
  double rest_density = 0;               ///< [kg/m³]
  Vec3 gravity = Vec3::Zero();           ///< [m/s²]
};

/// Gives solid bodies, and what is in front of them, the impulses of the pressure in their gaps (B.46) within
/// an interval of dt [s]. The trees must fit the interval. Returns the work on the surfaces [J], at the
/// speeds with which they move in the interval.
double press_gaps(const GapWater& water, Span<SurfaceMotion* const> surfaces,
                  Span<contact::SurfaceGeometry* const> geometry, double dt, const Workers& workers);

}  // namespace oilskin::world
