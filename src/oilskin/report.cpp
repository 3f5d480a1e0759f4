#include "oilskin/report.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/assert.h"

namespace oilskin {

StageSeconds& StageSeconds::operator+=(const StageSeconds& o) {
  gather += o.gather;
  neighbours += o.neighbours;
  pressure += o.pressure;
  occlusion += o.occlusion;
  boundary += o.boundary;
  other_fluid += o.other_fluid;
  proximity += o.proximity;
  impulses += o.impulses;
  ccd += o.ccd;
  zones += o.zones;
  effects += o.effects;
  verify += o.verify;
  return *this;
}

void ContactReport::add(const ContactReport& o) {
  OILSKIN_ASSERT(&o != this && !std::isnan(o.min_distance));
  candidates += o.candidates;
  contacts += o.contacts;
  impacts += o.impacts;
  ccd_iterations += o.ccd_iterations;
  zone_rounds += o.zone_rounds;
  zone_points += o.zone_points;
  held += o.held;
  separated += o.separated;
  stalled += o.stalled;
  carried_along += o.carried_along;
  removed += o.removed;
  allowed += o.allowed;
  started_too_close += o.started_too_close;
  relocated += o.relocated;
  min_distance = std::min(min_distance, o.min_distance);
  crossings_found_by_verify += o.crossings_found_by_verify;
  verified_pairs += o.verified_pairs;
  impulse_on_free_nodes += o.impulse_on_free_nodes;
  impulse_on_prescribed += o.impulse_on_prescribed;
  impulse_on_bodies += o.impulse_on_bodies;
  momentum_removed += o.momentum_removed;
  kinetic_energy_change += o.kinetic_energy_change;
}

FluidReport worst_of(const FluidReport& a, const FluidReport& b) {
  FluidReport worst;
  worst.iterations = a.iterations + b.iterations;
  worst.divergence_iterations = a.divergence_iterations + b.divergence_iterations;
  worst.density_error_mean = std::max(a.density_error_mean, b.density_error_mean);
  worst.density_error_max = std::max(a.density_error_max, b.density_error_max);
  worst.converged = a.converged && b.converged;
  worst.diverged = a.diverged || b.diverged;
  worst.hidden_pairs = a.hidden_pairs + b.hidden_pairs;
  return worst;
}

Vec3 StepReport::momentum_residual() const {
  return momentum_after - momentum_before - momentum_emitted + momentum_removed + momentum_absorbed -
         momentum_released - momentum_gravity - momentum_effects + contact.impulse_on_free_nodes +
         contact.impulse_on_prescribed + contact.impulse_on_bodies;
}

namespace {

constexpr std::size_t most_messages = 256;

/// Equal for messages about the same surfaces that differ in numbers alone: the message without what numbers
/// are written with, and the numbers of its surfaces.
std::string kind_of(const std::string& message) {
  constexpr std::string_view in_numbers = "0123456789.e+-", before_id = "surface ";
  std::string kind;
  for (const char c : message)
    if (in_numbers.find(c) == std::string_view::npos) kind += c;
  for (std::size_t at = message.find(before_id); at != std::string::npos; at = message.find(before_id, at)) {
    at += before_id.size();
    kind += ' ' + message.substr(at, message.find_first_not_of("0123456789", at) - at);
  }
  return kind;
}

template <class T>
void keep_larger(T& largest, const T& value) {
  largest = std::max(largest, value);
}

}  // namespace

void StepReport::add_world(const StepReport& other) {
  const StepReport own = *this;
  add(other);
  step = own.step, time = own.time, dt = own.dt, energy = own.energy, substeps = own.substeps;
  if (!other.status.ok()) return;
  fluid = worst_of(own.fluid, other.fluid);
  substeps_left_out = std::max(own.substeps_left_out, other.substeps_left_out);
  alive = own.alive + other.alive;
  momentum_before = own.momentum_before + other.momentum_before;
  momentum_after = own.momentum_after + other.momentum_after;
}

// Structured bindings name every member: a new member that is not added does not compile.
void StepReport::add(const StepReport& next) {
  if (status.ok()) status = next.status;
  for (const std::string& message : next.messages) add_message(message, &messages);
  if (!next.status.ok()) return;
  const bool is_first = dt == 0;
  const double made_before = energy.made_in_step, speed_before = energy.max_speed;
  const auto& [status_, messages_, step_, time_, dt_, substeps_, needed, left_out, limit, seconds_, fluid_,
               contact_, alive_, emitted_, removed_, by_sinks, by_age, absorbed_, released_, invalid,
               too_fast, blocked, limited, mass_emitted_, mass_removed_, mass_absorbed_, mass_released_,
               mass_dried_, mass_lost_, before, after, momentum_emitted_, momentum_removed_,
               momentum_absorbed_, momentum_released_, gravity, effects, energy_, owed, carried, load,
               flags_] = next;
  static_cast<void>(status_), static_cast<void>(messages_);
  step = step_, time = time_, alive = alive_, momentum_after = after, energy = energy_;
  energy.made_in_step += made_before;
  keep_larger(energy.max_speed, speed_before);
  if (is_first) momentum_before = before;
  fluid = is_first ? fluid_ : worst_of(fluid, fluid_);
  contact.add(contact_);
  seconds += seconds_;
  dt += dt_, substeps += substeps_, substeps_left_out += left_out;
  if (limit > 0) iteration_limit = iteration_limit > 0 ? std::min(iteration_limit, limit) : limit;
  emitted += emitted_, removed += removed_, absorbed += absorbed_, released += released_;
  removed_by_sinks += by_sinks, removed_by_age += by_age;
  removed_invalid += invalid, removed_too_fast += too_fast;
  blocked_starts += blocked, limited_starts += limited;
  mass_emitted += mass_emitted_, mass_removed += mass_removed_, mass_absorbed += mass_absorbed_;
  mass_released += mass_released_, mass_dried += mass_dried_, mass_lost += mass_lost_;
  momentum_emitted += momentum_emitted_, momentum_removed += momentum_removed_;
  momentum_absorbed += momentum_absorbed_, momentum_released += momentum_released_;
  momentum_gravity += gravity, momentum_effects += effects, momentum_owed += owed;
  keep_larger(substeps_needed, needed);
  keep_larger(carried_ratio, carried);
  keep_larger(load_speed, load);
  flags |= flags_;
}

std::vector<std::string> flag_texts(std::uint32_t flags) {
  static const std::pair<StepFlag, const char*> all[] = {
      {flag_pressure_not_converged, "pressure_not_converged: raise fluid.max_iterations, or lower dt"},
      {flag_leaked, "leaked: contact.infeasible is allow and a particle passed; use stall or remove"},
      {flag_stalled, "stalled: prescribed nodes close on particles and were held; slow their motion"},
      {flag_removed_by_contact, "removed_by_contact: particles between prescribed surfaces were removed"},
      {flag_removed_invalid, "quarantined: non-finite particles were removed; lower dt"},
      {flag_surface_out_of_range, "surface_out_of_range: a surface left the kill box; enlarge it"},
      {flag_surface_refused, "surface_refused: a surface was left out"},
      {flag_many_holds,
       "many_holds: nodes or bodies were held; use more cloth substeps or iterations, leave space between "
       "bodies and walls"},
      {flag_no_promise, "no_promise: contact.ccd or contact.zones is off, or particles started too close"},
      {flag_scatter_mismatch, "scatter_mismatch: the host does not store the numbers that it is given"},
      {flag_pressure_diverged, "pressure_diverged: lower dt, or keep fluid.support_ratio at 2.2 or below"},
      {flag_energy_made, "energy_made: the step is too long for the water or for light cloth; see messages"},
      {flag_viscosity_limited,
       "viscosity_limited: a smaller viscosity than fluid.viscosity was applied; lower dt or raise "
       "fluid.max_substeps"},
      {flag_sound_too_fast,
       "sound_too_fast: dt > 0.4 H/(sqrt(fluid.stiffness) + v) for mcg03; lower dt or raise "
       "fluid.max_substeps"},
      {flag_budget_limited,
       "budget_limited: step_budget left out fluid sub-steps or iterations of the pressure solver; raise it, "
       "or "
       "use fewer particles"},
      {flag_load_limited,
       "load_limited: the intervals are too long for the weight of the water, which is compressed; raise "
       "fluid.max_substeps, or lower dt"},
  };
  std::vector<std::string> texts;
  for (const auto& [bit, text] : all)
    if ((flags & bit) != 0) texts.emplace_back(text);
  return texts;
}

void add_message(const std::string& message, std::vector<std::string>* list) {
  OILSKIN_ASSERT(list != nullptr);
  const std::string kind = kind_of(message);
  const auto known =
      std::find_if(list->begin(), list->end(), [&](const std::string& m) { return kind_of(m) == kind; });
  if (known != list->end())
    *known = message;
  else if (list->size() < most_messages)
    list->push_back(message);
}

}  // namespace oilskin
