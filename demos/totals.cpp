#include "totals.h"

#include <algorithm>

namespace oilskin::demo {

void Totals::add(const StepReport& r) {
  ++steps;
  simulated = r.time;
  seconds += r.seconds;
  contact.add(r.contact);
  emitted += r.emitted;
  removed += r.removed;
  quarantined += r.quarantined;
  blocked_starts += r.blocked_starts;
  mass_emitted += r.mass_emitted;
  mass_removed += r.mass_removed;
  density_error_sum += r.fluid.density_error_mean;
  density_error_max = std::max(density_error_max, r.fluid.density_error_max);
  pressure_iterations += static_cast<std::uint64_t>(r.fluid.iterations);
  momentum_emitted += r.momentum_emitted;
  momentum_removed += r.momentum_removed;
  momentum_gravity += r.momentum_gravity;
  momentum_residual += r.momentum_residual();
  momentum_scale += r.momentum_emitted.norm() + r.momentum_removed.norm() + r.momentum_gravity.norm() +
                    r.contact.impulse_on_free_nodes.norm() + r.contact.impulse_on_prescribed.norm();
  flags |= r.flags;
  for (const std::string& message : r.messages)
    if (std::find(messages.begin(), messages.end(), message) == messages.end()) messages.push_back(message);
}

Vec3 fluid_momentum(const World& world) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : world.velocities()) sum += v;
  return sum * world.particle_mass();
}

std::vector<std::string> flag_texts(std::uint32_t flags) {
  static const std::pair<StepFlag, const char*> all[] = {
      {flag_pressure_not_converged, "pressure_not_converged: raise fluid.max_iterations, or lower dt"},
      {flag_leaked, "leaked: contact.infeasible is allow and a particle passed; use stall or remove"},
      {flag_stalled, "stalled: prescribed nodes close on particles and were held; slow their motion"},
      {flag_removed_by_contact, "removed_by_contact: particles were given up between prescribed surfaces"},
      {flag_quarantined, "quarantined: non-finite particles were removed; lower dt"},
      {flag_surface_out_of_range, "surface_out_of_range: a surface left the kill box; enlarge it"},
      {flag_surface_refused, "surface_refused: a surface was left out"},
      {flag_many_holds, "many_holds: nodes were held; use more cloth substeps or iterations"},
      {flag_no_promise, "no_promise: contact.ccd or contact.zones is off, or particles began too close"},
      {flag_scatter_mismatch, "scatter_mismatch: the host does not store what it is given"},
      {flag_pressure_diverged, "pressure_diverged: keep fluid.support_ratio at 2.2 or below"},
  };
  std::vector<std::string> texts;
  for (const auto& [bit, text] : all)
    if ((flags & bit) != 0) texts.emplace_back(text);
  return texts;
}

}  // namespace oilskin::demo
