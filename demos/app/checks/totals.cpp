#include "checks/totals.h"

#include <algorithm>

namespace oilskin::demo {

void Totals::add(const StepReport& r) {
  ++steps;
  substeps += static_cast<std::uint64_t>(r.substeps);
  simulated = r.time;
  seconds += r.seconds;
  contact.add(r.contact);
  emitted += r.emitted;
  removed += r.removed;
  removed_by_sinks += r.removed_by_sinks;
  removed_by_age += r.removed_by_age;
  removed_invalid += r.removed_invalid;
  blocked_starts += r.blocked_starts;
  limited_starts += r.limited_starts;
  mass_emitted += r.mass_emitted;
  mass_removed += r.mass_removed;
  absorbed += r.absorbed;
  released += r.released;
  mass_absorbed += r.mass_absorbed;
  mass_released += r.mass_released;
  mass_dried += r.mass_dried;
  mass_lost += r.mass_lost;
  density_error_sum += r.fluid.density_error_mean;
  density_error_max = std::max(density_error_max, r.fluid.density_error_max);
  pressure_iterations += static_cast<std::uint64_t>(r.fluid.iterations);
  momentum_emitted += r.momentum_emitted;
  momentum_removed += r.momentum_removed;
  momentum_gravity += r.momentum_gravity;
  momentum_residual += r.momentum_residual();
  momentum_scale += r.momentum_emitted.norm() + r.momentum_removed.norm() + r.momentum_gravity.norm() +
                    r.contact.impulse_on_free_nodes.norm() + r.contact.impulse_on_prescribed.norm() +
                    r.contact.impulse_on_bodies.norm();
  energy = r.energy;
  max_made = std::max(max_made, r.energy.made);
  max_risen = std::max(max_risen, r.energy.risen);
  max_made_fraction = std::max(max_made_fraction, r.energy.made_fraction());
  removed_too_fast += r.removed_too_fast;
  if ((r.flags & flag_pressure_diverged) != 0) ++diverged_steps;
  flags |= r.flags;
  for (const std::string& message : r.messages) {
    if (message.rfind("energy made", 0) == 0) {
      // That of the worst step remains, not the last one.
      if (r.energy.risen_fraction() > max_risen_fraction) energy_message = message;
    } else {
      add_message(message, &messages);
    }
  }
  max_risen_fraction = std::max(max_risen_fraction, r.energy.risen_fraction());
}

Vec3 fluid_momentum(const World& world) {
  const Span<const float> ratio = world.mass_ratios();
  const Span<const Vec3> velocity = world.velocities();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < velocity.size(); ++i)
    sum += ratio.empty() ? velocity[i] : Vec3(static_cast<double>(ratio[i]) * velocity[i]);
  return sum * world.particle_mass();
}

}  // namespace oilskin::demo
