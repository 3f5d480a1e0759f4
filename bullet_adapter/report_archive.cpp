#include "report_archive.h"

#include "bullet_archive.h"

// Structured bindings name every member: a new member that is not saved does not compile.

namespace oilskin::bullet {

namespace {

void visit_seconds(Archive& archive, StageSeconds& seconds) {
  auto& [gather, neighbours, pressure, occlusion, boundary, other_fluid, proximity, impulses, ccd, zones,
         effects, verify] = seconds;
  archive.values(gather, neighbours, pressure, occlusion, boundary, other_fluid, proximity, impulses, ccd,
                 zones, effects, verify);
}

void visit_contact(Archive& archive, ContactReport& report) {
  auto& [candidates, contacts, impacts, ccd_iterations, zone_rounds, zone_points, held, separated, stalled,
         carried_along, removed, allowed, started_too_close, relocated, min_distance, crossings, pairs,
         on_free, on_prescribed, on_bodies, momentum_removed, energy_change] = report;
  archive.values(candidates, contacts, impacts, ccd_iterations, zone_rounds, zone_points, held, separated,
                 stalled, carried_along, removed, allowed, started_too_close, relocated, min_distance,
                 crossings, pairs, on_free, on_prescribed, on_bodies, momentum_removed, energy_change);
}

void visit_fluid(Archive& archive, FluidReport& report) {
  auto& [iterations, divergence_iterations, error_mean, error_max, converged, diverged, hidden_pairs] =
      report;
  archive.values(iterations, divergence_iterations, error_mean, error_max, converged, diverged, hidden_pairs);
}

void visit_energy(Archive& archive, EnergyReport& report) {
  auto& [water_kinetic, water_potential, node_kinetic, node_potential, transfer, entered_kinetic,
         entered_potential, left_kinetic, left_potential, work_prescribed, work_host, work_outside, released,
         made, made_in_step, risen, scale, rms_speed, max_speed] = report;
  archive.values(water_kinetic, water_potential, node_kinetic, node_potential, transfer, entered_kinetic,
                 entered_potential, left_kinetic, left_potential, work_prescribed, work_host, work_outside,
                 released, made, made_in_step, risen, scale, rms_speed, max_speed);
}

}  // namespace

void visit(Archive& archive, StepReport& report) {
  auto& [status, messages, step, time, dt, substeps, substeps_needed, substeps_left_out, iteration_limit,
         seconds, fluid, contact, alive, emitted, removed, removed_by_sinks, removed_by_age, absorbed,
         released, removed_invalid, removed_too_fast, blocked_starts, limited_starts, mass_emitted,
         mass_removed, mass_absorbed, mass_released, mass_dried, mass_lost, momentum_before, momentum_after,
         momentum_emitted, momentum_removed, momentum_absorbed, momentum_released, momentum_gravity,
         momentum_effects, energy, momentum_owed, carried_ratio, load_speed, flags] = report;
  visit(archive, status.message);
  visit(archive, messages);
  archive.values(step, time, dt, substeps, substeps_needed, substeps_left_out, iteration_limit);
  visit_seconds(archive, seconds);
  visit_fluid(archive, fluid);
  visit_contact(archive, contact);
  archive.values(alive, emitted, removed, removed_by_sinks, removed_by_age, absorbed, released,
                 removed_invalid, removed_too_fast, blocked_starts, limited_starts, mass_emitted,
                 mass_removed, mass_absorbed, mass_released, mass_dried, mass_lost);
  archive.values(momentum_before, momentum_after, momentum_emitted, momentum_removed, momentum_absorbed,
                 momentum_released, momentum_gravity, momentum_effects);
  visit_energy(archive, energy);
  archive.values(momentum_owed, carried_ratio, load_speed, flags);
}

}  // namespace oilskin::bullet
