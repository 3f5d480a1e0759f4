/// The starts of emitters in a step.
#include <algorithm>
#include <map>

#include "core/assert.h"
#include "world/free_starts.h"
#include "world/particle_limit.h"
#include "world/work_of_starts.h"
#include "world/world_impl.h"

namespace oilskin {

using world::IntervalContext;
using world::StepContext;

namespace {

/// An emitter that was moved, or a volume that is larger than the kill box, would give less water than asked.
void note_starts_outside(const std::vector<fluid::Start>& starts, const std::vector<fluid::Outcome>& outcomes,
                         const Box& kill_box, StepReport& report) {
  std::size_t outside = 0;
  for (std::size_t k = 0; k < starts.size(); ++k)
    outside += outcomes[k] == fluid::Outcome::blocked && !kill_box.contains(starts[k].position);
  if (outside > 0)
    add_message(std::to_string(outside) +
                    " starts of emitters were left out, since they lie outside of the kill box: enlarge "
                    "WorldSettings::kill_box, or move the emitter",
                &report.messages);
}

/// A volume without a free start gives no water at all, as does a nozzle in a wall: a mistake of the scene.
void note_starts_without_room(const std::vector<fluid::Start>& starts,
                              const std::vector<fluid::Outcome>& outcomes, const Box& kill_box,
                              bool has_emitted, StepReport& report) {
  std::map<std::uint32_t, std::pair<std::size_t, std::size_t>> due_and_blocked;  // by volume; 0 = nozzles
  for (std::size_t k = 0; k < starts.size(); ++k) {
    auto& [due, blocked] = due_and_blocked[starts[k].volume];
    ++due;
    blocked += outcomes[k] == fluid::Outcome::blocked && kill_box.contains(starts[k].position);
  }
  for (const auto& [volume, count] : due_and_blocked)
    if (count.second == count.first && (volume != 0 || !has_emitted))
      add_message("none of the " + std::to_string(count.first) + " starts of " +
                      (volume != 0 ? "a volume" : "the nozzles") +
                      " is free: they lie in or at a surface, or in water that is there",
                  &report.messages);
}

}  // namespace

void World::Impl::emit(IntervalContext& interval) {
  StepContext& step = interval.step;
  StageTimer timer(step.report.seconds.other_fluid);
  fluid::Particles& particles = state.particles;
  interval.live = particles.size();
  if (interval.is_first) {
    step.ledger.present_before(particles.sum_of_velocities(*workers));
    step.energy.begin(particles, interval.dt, *workers);
  }
  const double live_mass = particles.sum_of_relative_masses();
  const std::vector<fluid::Start>& starts = emission->due(interval.begin, interval.dt);
  std::vector<fluid::Outcome> outcomes =
      world::judge_starts(starts, fluid_settings, settings.kill_box, step.surfaces, particles, *workers);
  note_starts_outside(starts, outcomes, settings.kill_box, step.report);
  note_starts_without_room(starts, outcomes, settings.kill_box, state.next_particle_id > 1, step.report);
  const std::uint64_t limit = world::particle_limit(settings);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const fluid::Start& start = starts[k];
    if (outcomes[k] == fluid::Outcome::blocked) continue;
    if (particles.size() >= limit) {
      ++step.report.limited_starts;
      outcomes[k] = fluid::Outcome::lost;  // it does not wait
      continue;
    }
    OILSKIN_ASSERT(start.remaining >= 0 && start.remaining <= interval.dt);
    particles.push_back(state.next_particle_id++, start.position, start.velocity,
                        fluid_settings.rest_density);
    if (particles.ends)
      particles.end_time.back() =
          interval.begin + interval.dt - start.remaining + std::min(start.max_age, state.max_age);
    interval.of_starts.push_back(start.remaining);
    step.ledger.emitted(start.velocity);
    step.energy.enter(start.position, start.velocity, interval.dt);
    step.ledger.gravity(1, start.remaining, settings.gravity);
  }
  step.energy.drive(world::work_of_starts(starts, outcomes, particles, interval.live, settings.gravity,
                                          fluid_settings, fluid->particle_mass()));
  step.ledger.emitted_mass(particles.size() - interval.live);
  step.ledger.gravity(live_mass, interval.dt, settings.gravity);
  step.report.blocked_starts += emission->settle(outcomes);
}

}  // namespace oilskin
