#include "checks/acceptance.h"

#include <cmath>
#include <limits>

namespace oilskin::demo {
namespace {

CheckResult at_most(const char* name, double value, double limit) {
  return {name, value, limit, value <= limit};
}
CheckResult at_least(const char* name, double value, double limit) {
  return {name, value, limit, value >= limit};
}

double ratio(double a, double b) {
  return b > 0 ? a / b : (a > 0 ? std::numeric_limits<double>::infinity() : 0);
}

CheckResult crossings(const Totals& totals) {
  return at_most("crossings", static_cast<double>(totals.contact.crossings_found_by_verify), 0);
}

CheckResult finite_state(const Totals& totals, const Measurements& measured) {
  return at_most("not_finite", static_cast<double>(measured.not_finite + totals.quarantined), 0);
}

/// A surface that was left out stops nothing any more.
CheckResult surfaces_left_out(const Totals& totals) {
  return at_most("surfaces_left_out", (totals.flags & flag_surface_refused) != 0 ? 1 : 0, 0);
}

/// Relative to all that was exchanged; below one particle at 1 m/s there is nothing to compare with.
CheckResult momentum_closed(const Totals& totals, const World& world) {
  const double scale = std::max(totals.momentum_scale, world.particle_mass());
  return at_most("momentum_residual", ratio(totals.momentum_residual.norm(), scale), 1e-9);
}

CheckResult mass_closed(const Totals& totals, const World& world) {
  const double alive = world.particle_mass() * static_cast<double>(world.particle_count());
  return at_most("mass_residual",
                 ratio(std::abs(totals.mass_emitted - totals.mass_removed - alive), totals.mass_emitted),
                 1e-12);
}

/// Vertical momentum that the fluid lost, from its particles, against what the nodes got, from the hosts'
/// side.
CheckResult vertical_momentum(const Scene& scene, const Totals& totals, const Measurements& measured,
                              const World& world) {
  const Vec3 up = -scene.world.gravity.normalized();
  const Vec3 lost =
      totals.momentum_emitted + totals.momentum_gravity - totals.momentum_removed - fluid_momentum(world);
  const double got = measured.impulse_on_cloth.dot(up);
  return at_most("vertical_momentum", ratio(std::abs(lost.dot(up) - got), std::abs(lost.dot(up))),
                 *scene.acceptance.vertical_momentum);
}

/// Runs the same cloth without water, with the same steps: how stiff it is depends on them.
CheckResult sag_below_dry(const Scene& scene, const Measurements& measured, const SimulatedTime& time,
                          const SimulationOptions& options, const MakeSimulation& make_simulation) {
  SimulationOptions dry_options = options;
  dry_options.emitters = false;
  const auto dry = make_simulation(scene, dry_options);
  for (const SimulatedTime::Run& run : time.runs())
    for (std::uint64_t s = 0; s < run.count; ++s) dry->step(run.dt);
  const SurfaceMotion* motion = dry->cloth(0);
  const Vec3 dry_centre =
      motion != nullptr ? motion->x_t1[centre_node(dry->models()[0])] : measured.centre_node;
  const Vec3 down = scene.world.gravity.normalized();
  return at_least("sag_below_dry", (measured.centre_node - dry_centre).dot(down),
                  *scene.acceptance.sag_below_dry);
}

CheckResult slip_ratio(const Scene& scene, const Measurements& m) {
  auto mean = [&](int s) { return ratio(m.slip_way[s], m.slip_time[s]); };
  const bool seen = m.slip_time[0] > 0 && m.slip_time[1] > 0;
  return at_least("slip_ratio", seen ? ratio(mean(0), mean(1)) : 0, scene.acceptance.slip_ratio->at_least);
}

CheckResult pin_reaction(const Scene& scene, const Measurements& m) {
  const double off = m.weight_impulse > 0 ? std::abs(m.reaction_impulse / m.weight_impulse - 1)
                                          : std::numeric_limits<double>::infinity();
  return at_most("pin_reaction", off, scene.acceptance.pin_reaction->tolerance);
}

CheckResult pool_level(const Scene& scene, const Measurements& m) {
  return at_most("pool_level", m.above_pool_time > 0 ? m.above_pool_sum / m.above_pool_time : never,
                 scene.acceptance.pool_level->fraction);
}

CheckResult pool_calm(const Scene& scene, const Measurements& m) {
  return at_most("pool_calm", m.pool_energy_time > 0 ? m.pool_energy_sum / m.pool_energy_time : never,
                 scene.acceptance.pool_calm->fraction);
}

/// Water that was not looked at to the end was not seen to be at rest.
void at_rest(const Scene& scene, const Measurements& m, std::vector<CheckResult>* checks) {
  for (std::size_t i = 0; i < scene.acceptance.at_rest.size(); ++i) {
    const AtRestCheck& check = scene.acceptance.at_rest[i];
    const bool whole = check.to == never || scene.duration >= check.to;
    const bool seen = whole && i < m.rest_speed.size() && m.rest_speed[i] >= 0;
    const std::string name = "at_rest." + std::to_string(i);
    checks->push_back(at_most(name.c_str(), seen ? m.rest_speed[i] : never, check.speed));
  }
}

void dam_break(const Scene& scene, const Measurements& m, std::vector<CheckResult>* checks) {
  const DamBreakCheck& check = *scene.acceptance.dam_break;
  const DamFit fit{check.shift, check.front, check.height.value_or(never)};
  const DamComparison found = compare_with_martin_moyce(m.dam, check.width, scene.world.gravity.norm(), fit);
  checks->push_back(at_most("dam_front", found.front, check.front));
  // For the reader: how late the front is where it fits best. The search went no farther than the limit.
  checks->push_back({"dam_time_shift", found.shift, check.shift, std::abs(found.shift) <= check.shift});
  checks->push_back({"dam_front_speed", found.speed, 1, found.speed > 0 && found.speed <= 1});
  if (check.height) checks->push_back(at_most("dam_height", found.height, *check.height));
}

/// A cloth without water inside, or one that was never looked at, keeps no promise.
void inside_constant(const Measurements& m, std::vector<CheckResult>* checks) {
  checks->push_back(at_least("inside", static_cast<double>(m.inside), 1));
  checks->push_back(
      at_most("inside_changed", m.inside_looks > 1 ? static_cast<double>(m.inside_changed) : never, 0));
}

void enclosed_volume(const Scene& scene, const Measurements& m, std::vector<CheckResult>* checks) {
  const EnclosedVolumeCheck& check = *scene.acceptance.enclosed_volume;
  const bool seen = m.largest_volume > 0;
  checks->push_back(at_least("least_volume", seen ? m.least_volume : 0, check.at_least));
  checks->push_back(at_most("largest_volume", seen ? m.largest_volume : never, check.at_most));
}

/// Windows that overlap or were never reached show no decay.
CheckResult energy_decay(const Scene& scene, const Measurements& m) {
  const EnergyDecayCheck& check = *scene.acceptance.energy_decay;
  const bool apart = check.from + check.window <= scene.duration - check.window;
  const bool seen = apart && m.energy_time[0] > 0 && m.energy_time[1] > 0 && m.energy_sum[0] > 0;
  const auto mean = [&](int window) { return m.energy_sum[window] / m.energy_time[window]; };
  return at_most("energy_decay", seen ? mean(1) / mean(0) : never, check.fraction);
}

CheckResult memory_growth(const Scene& scene, const Measurements& m) {
  const double before = static_cast<double>(m.resident_at_fifth),
               after = static_cast<double>(m.resident_at_end);
  return at_most("memory_growth", before > 0 ? after / before - 1 : never, *scene.acceptance.memory_growth);
}

}  // namespace

std::vector<CheckResult> check_acceptance(const Scene& scene, const Totals& totals,
                                          const Measurements& measured, Simulation& simulation,
                                          const SimulationOptions& options,
                                          const MakeSimulation& make_simulation) {
  const Acceptance& a = scene.acceptance;
  std::vector<CheckResult> checks;
  if (scene.contact.verify) checks.push_back(crossings(totals));
  checks.push_back(finite_state(totals, measured));
  checks.push_back(surfaces_left_out(totals));
  checks.push_back(momentum_closed(totals, simulation.world()));
  checks.push_back(mass_closed(totals, simulation.world()));
  if (a.min_emitted)
    checks.push_back(at_least("emitted", static_cast<double>(totals.emitted), *a.min_emitted));
  if (a.min_over_rim)
    checks.push_back(at_least("over_rim", static_cast<double>(measured.over_rim.size()), *a.min_over_rim));
  if (a.vertical_momentum) checks.push_back(vertical_momentum(scene, totals, measured, simulation.world()));
  if (a.sag_below_dry)
    checks.push_back(sag_below_dry(scene, measured, simulation.time(), options, make_simulation));
  if (a.max_stretch) checks.push_back(at_most("stretch", measured.largest_stretch, *a.max_stretch));
  if (a.slip_ratio) checks.push_back(slip_ratio(scene, measured));
  if (a.pin_reaction) checks.push_back(pin_reaction(scene, measured));
  if (a.dry_shadow) checks.push_back(at_most("in_shadow", static_cast<double>(measured.in_shadow), 0));
  if (a.pool_level) checks.push_back(pool_level(scene, measured));
  if (a.pool_calm) checks.push_back(pool_calm(scene, measured));
  at_rest(scene, measured, &checks);
  if (a.dam_break) dam_break(scene, measured, &checks);
  if (a.inside_constant) inside_constant(measured, &checks);
  if (a.enclosed_volume) enclosed_volume(scene, measured, &checks);
  if (a.energy_decay) checks.push_back(energy_decay(scene, measured));
  if (a.close_layers)
    checks.push_back(
        at_least("close_layers", static_cast<double>(measured.close_nodes), a.close_layers->at_least));
  if (a.memory_growth) checks.push_back(memory_growth(scene, measured));
  return checks;
}

void check_surfaces(const Scene& scene, const SurfaceTotals& surfaces, std::vector<CheckResult>& checks) {
  const auto none = [&](const char* name, std::uint64_t count) {
    checks.push_back(at_most(name, static_cast<double>(count), 0));
  };
  none("surface_flaws", surfaces.flaws);
  const SurfaceContact mode = scene.surface->mode;
  if (mode == SurfaceContact::overlap) return;
  none("surface_intersections", surfaces.intersecting_pairs);
  none("surface_submerged", surfaces.submerged);
  none("surface_below_gap", surfaces.near_pairs);
}

}  // namespace oilskin::demo
