/// The particles of several worlds in one contact pass.
#pragma once

#include "fluid/boundary/wall_impulse.h"
#include "fluid/particles.h"
#include "world/step_context.h"

namespace oilskin::world {

/// One world after the other: one value per particle.
struct JointParticles {
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1, velocity, start_velocity, spare_load;
  std::vector<double> inverse_mass;
  std::vector<std::uint8_t> removed;
  std::vector<std::uint8_t> liquid_index;  // the number of the world

  std::vector<fluid::WallImpulse> wall_impulses;  // of all

  /// Adds those of a world, which proposes their motion.
  void add(std::uint8_t world, const fluid::Particles& particles, const IntervalContext& interval);
  /// Gives those of a world, from `first` on, what contact has changed.
  void give_back(std::size_t first, fluid::Particles& particles, IntervalContext& interval) const;
};

}  // namespace oilskin::world
