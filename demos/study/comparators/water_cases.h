/// Water in a tank of triangles, by each method: at rest, and a dam that breaks.
#pragma once

#include "study/comparators/coupling_method.h"
#include "study/comparators/leak_counter.h"

namespace oilskin::study {

/// A column of 8 × 8 × layers particles in a tank that it fills from wall to wall.
struct ColumnCase {
  Method method = Method::oilskin;
  double dt = 1e-3;                 ///< [s]
  int layers = 20;                  ///< depth over spacing
  double duration = 1;              ///< [s]; what is measured are means over the second half
  std::optional<int> max_substeps;  ///< as MethodSettings::max_substeps
};

struct ColumnResult {
  ColumnCase setup;
  double force_over_weight = 0;  ///< of the impulses on the tank, and of the particles that remain
  double level_error = 0;  ///< twice the height of the centre of mass, over the depth of the lattice, − 1
  double first_layer = 0;  ///< height of the lowest 64 particles over the spacing; 0.5 in the lattice
  double pressure_error = 0;  ///< rms of p − ρ0 g (2 y_cm − y) between 2 dx and depth − 2 dx, over ρ0 g depth
  double pressure_slope = 0;  ///< of p over depth there, over ρ0 g: 1 = hydrostatic
  double density = 0;         ///< as the method computes it, there, over ρ0
  double rms_speed = 0;       ///< [m/s]
  LeakCount leaks;
  std::size_t particles = 0, remaining = 0;
  double seconds_per_second = 0;  ///< processor time of the method over simulated time
};

ColumnResult run(const ColumnCase& setup);

/// The case of [Martin1952] with n² = 2: a column of 2.25 inches by twice that, 8 spacings deep, in a tank.
struct DamCase {
  Method method = Method::oilskin;
  double dt = 1e-3;                 ///< [s]
  double spacing = 0.00519545;      ///< [m]: 11 particles along the base
  double duration = 0.18;           ///< [s]
  std::optional<int> max_substeps;  ///< as MethodSettings::max_substeps
};

struct DamResult {
  DamCase setup;
  double front_error = 0;    ///< mean of |Z − Z measured|/Z measured, 1.2 < Z < 4
  double front_lead = 0;     ///< mean of (Z − Z measured)/Z measured: > 0 = ahead
  double density_error = 0;  ///< mean over time of the mean compression beyond ρ0, as the method computes it
  double largest_density = 0;  ///< over time, of the mean density of the densest tenth, over ρ0
  double energy_gain = 0;      ///< largest rise of kinetic energy and height above the start, over the start
  LeakCount leaks;
  std::size_t particles = 0, remaining = 0;
  double seconds_per_second = 0;  ///< processor time of the method over simulated time
};

DamResult run(const DamCase& setup);

}  // namespace oilskin::study
