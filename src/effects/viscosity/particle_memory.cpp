#include "effects/viscosity/particle_memory.h"

#include <cmath>

#include "effects/viscosity/support_memory.h"

namespace oilskin::effects {

ParticleMemory::ParticleMemory(EffectForces& forces)
    : forces_(forces),
      drag_(ChannelVectors::of_particles(forces, 0)),
      free_(ChannelVectors::of_particles(forces, 3)),
      rest_(ChannelVectors::of_particles(forces, 6)),
      time_(forces.of_particles(9)) {}

void ParticleMemory::learn() const {
  forces_.for_each(time_.size(), [&](std::size_t i) {
    if (!(time_[i] > 0)) return;
    const Vec3 known = forces_.gravity + forces_.acceleration[i];
    Vec3 rest = (forces_.velocity[i] - free_.get(i)) / time_[i];
    const double size = rest.norm(), most = known.norm();
    if (size > most) rest *= most / size;
    rest_.set(i, rest_.get(i) - std::expm1(-time_[i] / memory_time) * (rest - rest_.get(i)));
  });
}

Vec3 ParticleMemory::expected(std::size_t i) const {
  Vec3 sum = rest_.get(i);
  const Span<const std::uint32_t> neighbours = forces_.neighbours(i);
  for (std::uint32_t j : neighbours) sum += rest_.get(j);
  return sum / static_cast<double>(1 + neighbours.size());
}

void ParticleMemory::record(std::size_t i, const Vec3& drag) const {
  drag_.set(i, drag);
  free_.set(i, forces_.velocity[i] + forces_.dt * (forces_.gravity + forces_.acceleration[i]));
  time_[i] = forces_.dt;
}

}  // namespace oilskin::effects
