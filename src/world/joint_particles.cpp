#include "world/joint_particles.h"

#include <algorithm>
#include <numeric>

#include "core/assert.h"

namespace oilskin::world {

namespace {

template <class T>
void append(std::vector<T>& all, const std::vector<T>& part) {
  all.insert(all.end(), part.begin(), part.end());
}

/// all[first …] → part
template <class T>
void take_part(const std::vector<T>& all, std::size_t first, std::vector<T>& part) {
  OILSKIN_ASSERT(first + part.size() <= all.size());
  std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(first), part.size(), part.begin());
}

std::uint64_t count(const std::vector<std::uint8_t>& flags) {
  return std::accumulate(flags.begin(), flags.end(), std::uint64_t{0});
}

}  // namespace

/// Ids are unique in each world: the number of the world comes first.
void JointParticles::add(std::uint8_t world, const fluid::Particles& particles,
                         const IntervalContext& interval) {
  for (std::uint64_t own : particles.id) id.push_back(own + (static_cast<std::uint64_t>(world) << 56));
  append(x_t0, particles.position);
  append(x_t1, interval.x_t1);
  append(velocity, interval.velocity);
  append(start_velocity, particles.velocity);
  append(spare_load, particles.spare_load);  // none: zeros
  spare_load.resize(id.size(), Vec3::Zero());
  append(inverse_mass, interval.inverse_mass);
  append(removed, interval.removed);
  liquid_index.resize(id.size(), world);
  OILSKIN_ASSERT(x_t1.size() == id.size() && spare_load.size() == id.size() && removed.size() == id.size());
}

void JointParticles::give_back(std::size_t first, fluid::Particles& particles,
                               IntervalContext& interval) const {
  const std::uint64_t before = count(interval.removed);
  take_part(x_t1, first, interval.x_t1);
  take_part(velocity, first, interval.velocity);
  take_part(removed, first, interval.removed);
  take_part(spare_load, first, particles.spare_load);
  interval.removed_by_contact = count(interval.removed) - before;
}

}  // namespace oilskin::world
