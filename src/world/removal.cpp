/// Removal of particles: by the caller, between steps, and of invalid ones at the start of a step.
#include <algorithm>

#include "core/refuse.h"
#include "world/numeric_range.h"
#include "world/world_impl.h"

namespace oilskin {

/// All that may throw comes first: the world is then as it was.
template <class Chosen>
std::uint64_t World::Impl::remove_where(Chosen chosen) {
  const std::size_t n = state.particles.size();
  std::vector<std::uint8_t> keep(n);
  for (std::size_t i = 0; i < n; ++i) keep[i] = !chosen(i);
  for (std::size_t i = 0; i < n; ++i)
    if (!keep[i]) withdraw(i);
  state.particles.compress(keep);
  return n - state.particles.size();
}

/// Numbers out of range have no momentum and no energy that a balance could hold, as in a step.
void World::Impl::withdraw(std::size_t particle) {
  const fluid::Particles& particles = state.particles;
  const double ratio = particles.relative_mass(particle);
  world::Withdrawn& withdrawn = state.withdrawn;
  ++withdrawn.count;
  withdrawn.mass_ratio += ratio;
  if (!world::is_in_range(particles, particle)) return;
  withdrawn.momentum += ratio * particles.velocity[particle];
  state.energy.withdraw(particles, particle, ratio * fluid->particle_mass());
}

void World::Impl::book_withdrawn(world::StepContext& step) {
  const world::Withdrawn& withdrawn = state.withdrawn;
  step.report.removed += withdrawn.count;
  step.ledger.withdrawn(withdrawn.mass_ratio, withdrawn.momentum);
  state.withdrawn = {};
}

Status World::remove_particles(const Box& box, std::uint64_t* removed) {
  if (Status s = check_box(box); !s.ok()) return s;
  const std::vector<Vec3>& x = impl_->state.particles.position;
  const std::uint64_t count = impl_->remove_where([&](std::size_t i) { return box.contains(x[i]); });
  if (removed) *removed = count;
  return {};
}

Status World::remove_particles(const Vec3& center, double radius, std::uint64_t* removed) {
  if (Status s = check_ball(center, radius); !s.ok()) return s;
  const std::vector<Vec3>& x = impl_->state.particles.position;
  const std::uint64_t count =
      impl_->remove_where([&](std::size_t i) { return (x[i] - center).stableNorm() <= radius; });
  if (removed) *removed = count;
  return {};
}

std::uint64_t World::remove_particles(Span<const std::uint64_t> ids) {
  std::vector<std::uint64_t> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  const std::vector<std::uint64_t>& id = impl_->state.particles.id;
  return impl_->remove_where(
      [&](std::size_t i) { return std::binary_search(sorted.begin(), sorted.end(), id[i]); });
}

void World::clear() {
  impl_->remove_where([](std::size_t) { return true; });
}

/// A stage of the step.
void World::Impl::remove_invalid_particles(world::StepContext& step) {
  constexpr std::size_t chunk = 2048;
  fluid::Particles& particles = state.particles;
  const auto is_valid = [&](std::size_t i) { return world::is_in_range(particles, i); };
  const auto count_invalid = [&](std::size_t begin, std::size_t end) {
    std::uint64_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += is_valid(i) ? 0 : 1;
    return count;
  };
  const std::uint64_t invalid =
      workers->ordered_sum(particles.size(), chunk, std::uint64_t{0}, count_invalid);
  if (invalid > 0) {
    std::vector<std::uint8_t> keep(particles.size(), 1);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (is_valid(i)) continue;
      keep[i] = 0;
      step.ledger.removed_without_momentum(particles.relative_mass(i));
    }
    particles.compress(keep);
    step.report.removed_invalid += invalid;
  }
}

}  // namespace oilskin
