/// Work of emitters that start water below other water.
#pragma once

#include "fluid/emission/emission.h"
#include "fluid/particles.h"
#include "oilskin/settings.h"

namespace oilskin::world {

/// What the starts of nozzles and rain with outcome `emitted` do against the weight of the water above them
/// (F.76) [J]. The first `live` particles were there before, with the pressures of their last interval.
/// Volumes do none: they start where no water is.
double work_of_starts(const std::vector<fluid::Start>& starts, const std::vector<fluid::Outcome>& outcomes,
                      const fluid::Particles& particles, std::size_t live, const Vec3& gravity,
                      const FluidSettings& fluid, double particle_mass);

}  // namespace oilskin::world
