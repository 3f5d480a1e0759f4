/// A column of water that collapses along a floor, held against Martin and Moyce's experiment.
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin::demo {

/// Place of the column: its foot at the wall that stays, the direction in which it runs, and up.
struct DamPlace {
  Vec3 foot = Vec3::Zero();
  Vec3 along = Vec3(1, 0, 0), up = Vec3(0, 1, 0);  ///< of length 1, square to each other
  double width = 0.05715;                          ///< a of the column at the start [m]; it is 2a high
  double breadth = 0.05;                           ///< of the tank, across `along` and `up` [m]
  double spacing = 0.005;                          ///< of the particles [m]
};

/// The water at one moment, in metres.
struct DamMoment {
  double t = 0;       ///< [s]
  double front = 0;   ///< farthest reach of the water from the wall
  double height = 0;  ///< of the column at the wall
};

/// The largest set of particles that are linked by gaps of less than `reach` [m]: without it a single drop of
/// spray would be the front.
std::vector<Vec3> bulk_of(Span<const Vec3> positions, double reach);

/// Front: the 99.5 % quantile of the distance from the wall over the bulk, and half a spacing, because a
/// particle's water reaches that much farther than its centre. Height: mean depth of the bulk within a/4 of
/// the wall, by its volume: a quantile there would be the height of the last drops that cling to the wall.
DamMoment look_at_dam(Span<const Vec3> positions, const DamPlace& place, double t);

/// A run against the experiment. Times in units of sqrt(a/(2g)), lengths in units of a.
struct DamComparison {
  /// Largest relative difference of the front where the measured one is between 1.2 a and 4 a. Not finite
  /// when the run does not cover that.
  double front = std::numeric_limits<double>::infinity();
  /// Largest relative difference of the column's height over the same time, from the experiment's first one
  /// on.
  double height = std::numeric_limits<double>::infinity();
  /// The means of both differences over the same moments of the experiment.
  double mean_front = std::numeric_limits<double>::infinity();
  double mean_height = std::numeric_limits<double>::infinity();
  double shift = 0;  ///< by which the run is taken to be later than the experiment: the one that fits best
  double speed = 0;  ///< fastest front over Ritter's 2 sqrt(2 g a) of a dam that vanishes
};

/// Tolerances of the fit.
struct DamFit {
  double max_shift = 0.15;
  double front = 0.1;                                       ///< tolerated difference
  double height = std::numeric_limits<double>::infinity();  ///< tolerated difference; infinite: not looked at
};

/// `gravity` [m/s²] > 0. The shift taken is the one at which the worse of both differences, each over what is
/// tolerated of it, is least.
DamComparison compare_with_martin_moyce(const std::vector<DamMoment>& run, double width, double gravity,
                                        const DamFit& fit);

}  // namespace oilskin::demo
