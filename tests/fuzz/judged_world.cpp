// What must hold after each step of a random world.
#include "fuzz/drawn_world.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "contact/zones.h"

namespace oilskin::test {

namespace {

/// Rounding of sums in the ledgers, relative to the sum of all magnitudes in them.
constexpr double ledger_tolerance = 1e-10;

}  // namespace

void DrawnWorld::expect(bool holds, const std::string& what) {
  if (!holds) verdict_.faults.push_back("step " + std::to_string(verdict_.steps) + ": " + what);
}

double DrawnWorld::node_momentum() const {
  double sum = 0;
  for (const Sheet& s : sheets_)
    if (const SurfaceMotion* m = s.id ? world_->surface(s.id) : nullptr)
      for (std::size_t i = 0; i < m->velocity.size() && i < m->inverse_mass.size(); ++i)
        if (m->inverse_mass[i] > 0 && !s.spoilt) sum += m->velocity[i].norm() / m->inverse_mass[i];
  return sum;
}

void DrawnWorld::check_finite() {
  const auto finite = [](Span<const Vec3> values) {
    return std::all_of(values.begin(), values.end(), [](const Vec3& x) { return x.allFinite(); });
  };
  const auto finite_numbers = [](Span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  };
  expect(finite(world_->positions()), "positions are not finite");
  expect(finite(world_->velocities()), "velocities are not finite");
  expect(finite_numbers(world_->densities()), "densities are not finite");
  expect(finite_numbers(world_->pressures()), "pressures are not finite");
  for (const Sheet& s : sheets_) {
    if (!s.id || s.spoilt) continue;
    const SurfaceMotion& m = *world_->surface(s.id);
    expect(finite(m.x_t1) && finite(m.velocity) && finite(m.impulse), "a surface is not finite");
    bool stored_numbers = true;
    for (const Vec3& x : m.x_t1) stored_numbers &= x == stored(x, m.storage);
    expect(stored_numbers, "a surface holds numbers that its host cannot store");
  }
}

void DrawnWorld::check_counts(const StepReport& r, const Before& before) {
  const ContactReport& c = r.contact;
  const ContactSettings& settings = world_->contact_settings();
  const auto substeps = static_cast<std::uint64_t>(r.substeps);
  expect(r.alive == world_->particle_count(), "alive");
  expect(before.alive + r.emitted == r.alive + r.removed + r.removed_invalid, "particles are lost or made");
  const double m = world_->particle_mass();
  const double out = m * static_cast<double>(r.removed + r.removed_invalid),
               in = m * static_cast<double>(r.emitted);
  expect(std::abs(r.mass_removed - out) <= 1e-12 * out, "mass removed");
  expect(std::abs(r.mass_emitted - in) <= 1e-12 * in, "mass emitted");
  expect(substeps >= 1 && r.substeps <= world_->fluid_settings().max_substeps, "sub-steps");
  expect(c.ccd_iterations <= substeps * static_cast<std::uint64_t>(settings.ccd_iterations), "rounds");
  expect(c.zone_rounds <= substeps * contact::max_zone_rounds,
         "zone rounds: " + std::to_string(c.zone_rounds));
  expect(r.fluid.iterations <= r.substeps * world_->fluid_settings().max_iterations, "iterations");
  expect(c.stalled <= c.held, "stalled");
  expect(c.removed <= r.removed, "removed");
  expect(settings.infeasible == Infeasible::allow || c.allowed == 0, "allowed without leave");
  expect(settings.infeasible == Infeasible::stall || c.stalled == 0, "stalled without leave");
  expect(settings.infeasible != Infeasible::allow || c.removed == 0, "removed without leave");
  const auto flag_says = [&](StepFlag flag, bool is) {
    expect(((r.flags & flag) != 0) == is, flag_texts(flag)[0]);
  };
  flag_says(flag_leaked, c.allowed > 0);
  flag_says(flag_stalled, c.stalled > 0);
  flag_says(flag_removed_by_contact, c.removed > 0);
  flag_says(flag_removed_invalid, r.removed_invalid > 0);
  flag_says(flag_many_holds, c.held > 0);
  flag_says(flag_scatter_mismatch, false);
  flag_says(flag_surface_out_of_range, before.out_of_range);
  flag_says(flag_surface_refused,
            std::any_of(sheets_.begin(), sheets_.end(), [](const Sheet& s) { return s.id && s.spoilt; }));
  verdict_.particles += r.alive;
  verdict_.impacts += c.impacts;
  verdict_.zone_steps += c.zone_rounds > 0;
  verdict_.max_zone_rounds = std::max(verdict_.max_zone_rounds, c.zone_rounds / substeps);
  verdict_.stalled += c.stalled;
  verdict_.carried_along += c.carried_along;
  verdict_.removed += c.removed;
  verdict_.allowed += c.allowed;
  verdict_.relocated += c.relocated;
  verdict_.removed_invalid += r.removed_invalid;
  verdict_.blocked += r.blocked_starts;
}

void DrawnWorld::check_momentum(const StepReport& r, const Before& before) {
  const double m = world_->particle_mass();
  Vec3 fluid = Vec3::Zero(), on_nodes = Vec3::Zero();
  double size = before.node_momentum + node_momentum() + r.momentum_before.norm() +
                r.momentum_removed.norm() + r.momentum_emitted.norm() + r.momentum_gravity.norm() +
                r.momentum_effects.norm();
  for (const Vec3& v : world_->velocities()) {
    fluid += m * v;
    size += m * v.norm();
  }
  for (const Sheet& s : sheets_) {
    const SurfaceMotion* motion = s.id && !s.spoilt ? world_->surface(s.id) : nullptr;
    if (!motion) continue;
    for (const Vec3& j : motion->impulse) {
      on_nodes += j;
      size += j.norm();
    }
  }
  const double residual = r.momentum_residual().norm();
  if (residual > ledger_tolerance * size && r.removed_invalid >= 2) {
    // Two particles that the pressure drove apart at 1e18 m/s have momenta that cancel in the report's sum.
    // Their rounding error is no fault.
    ++verdict_.not_judged;
  } else {
    if (size > 0) verdict_.worst_momentum = std::max(verdict_.worst_momentum, residual / size);
    std::ostringstream text;
    text << "momentum: residual " << residual << " of " << size;
    expect(residual <= ledger_tolerance * size, text.str());
  }
  expect((fluid - r.momentum_after).norm() <= ledger_tolerance * size, "momentum_after");
  const Vec3 booked = r.contact.impulse_on_free_nodes + r.contact.impulse_on_prescribed;
  expect((booked - on_nodes).norm() <= ledger_tolerance * size, "impulses are not what is booked");
}

bool DrawnWorld::nothing_is_driven() const {
  for (const Sheet& s : sheets_) {
    const SurfaceMotion* m = s.id && !s.spoilt ? world_->surface(s.id) : nullptr;
    if (!m) continue;
    for (std::size_t i = 0; i < m->x_t1.size(); ++i)
      if (m->inverse_mass[i] == 0 && (m->x_t1[i] != m->x_t0[i] || m->velocity[i] != Vec3::Zero()))
        return false;
  }
  return true;
}

/// Contact takes energy, where nothing drives it and no spring gives.
void DrawnWorld::check_energy(const StepReport& r) {
  if (!all_slip_free_ || world_->contact_settings().repulsion == Repulsion::bridson || !nothing_is_driven())
    return;
  double energy = std::abs(r.contact.kinetic_energy_change);
  for (const Vec3& v : world_->velocities()) energy += 0.5 * world_->particle_mass() * v.squaredNorm();
  for (const Sheet& s : sheets_) {
    const SurfaceMotion* m = s.id && !s.spoilt ? world_->surface(s.id) : nullptr;
    if (!m) continue;
    for (std::size_t i = 0; i < m->velocity.size(); ++i)
      if (m->inverse_mass[i] > 0) energy += 0.5 * m->velocity[i].squaredNorm() / m->inverse_mass[i];
  }
  std::ostringstream text;
  text << "contact gives energy: " << r.contact.kinetic_energy_change << " of " << energy << " J";
  expect(r.contact.kinetic_energy_change <= 1e-12 * r.substeps * energy, text.str());
}

void DrawnWorld::check_promise(const StepReport& r) {
  if (!verdict_.promised) return;
  const ContactReport& c = r.contact;
  something_passed_ |= c.allowed > 0;
  if (!something_passed_) {
    expect(c.started_too_close == 0, "a particle begins nearer than δ");
    expect((r.flags & flag_no_promise) == 0, "no promise");
  }
  // It counts a path that passes an edge within rounding (1e-17 m) as a crossing; the auditor decides.
  verdict_.false_alarms += c.crossings_found_by_verify > c.allowed;
  if (!leaks_allowed_) return;
  const audit::Summary s = watch_.judge();
  verdict_.pairs += s.pairs;
  // The auditor has seen the last interval before again, with what was allowed then.
  expect(s.jumps + s.invalid == 0, "the auditor finds jumps");
  if (!something_passed_) expect(s.findings() == 0, "the auditor finds what was not allowed");
}

}  // namespace oilskin::test
