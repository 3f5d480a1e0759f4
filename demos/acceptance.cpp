#include "acceptance.h"

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

CheckResult momentum_closed(const Totals& totals) {
  return at_most("momentum_residual", ratio(totals.momentum_residual.norm(), totals.momentum_scale), 1e-9);
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

/// Runs the same cloth without water.
CheckResult sag_below_dry(const Scene& scene, const Measurements& measured, std::uint64_t steps,
                          const SimulationOptions& options) {
  SimulationOptions dry_options = options;
  dry_options.emitters = false;
  const auto dry = make_simulation(scene, dry_options);
  for (std::uint64_t s = 0; s < steps; ++s) dry->step();
  const SurfaceMotion* motion = dry->cloth(0);
  const Vec3 dry_centre =
      motion != nullptr ? motion->x_t1[centre_node(dry->models()[0])] : measured.centre_node;
  const Vec3 down = scene.world.gravity.normalized();
  return at_least("sag_below_dry", (measured.centre_node - dry_centre).dot(down),
                  *scene.acceptance.sag_below_dry);
}

CheckResult slip_ratio(const Scene& scene, const Measurements& m) {
  auto mean = [&](int s) { return ratio(m.slip_speed_sum[s], static_cast<double>(m.slip_samples[s])); };
  const bool seen = m.slip_samples[0] > 0 && m.slip_samples[1] > 0;
  return at_least("slip_ratio", seen ? ratio(mean(0), mean(1)) : 0, scene.acceptance.slip_ratio->at_least);
}

CheckResult pin_reaction(const Scene& scene, const Measurements& m) {
  const double off = m.weight_impulse > 0 ? std::abs(m.reaction_impulse / m.weight_impulse - 1)
                                          : std::numeric_limits<double>::infinity();
  return at_most("pin_reaction", off, scene.acceptance.pin_reaction->tolerance);
}

}  // namespace

std::vector<CheckResult> check_acceptance(const Scene& scene, const Totals& totals,
                                          const Measurements& measured, Simulation& simulation,
                                          const SimulationOptions& options) {
  const Acceptance& a = scene.acceptance;
  std::vector<CheckResult> checks;
  if (scene.contact.verify) checks.push_back(crossings(totals));
  checks.push_back(finite_state(totals, measured));
  checks.push_back(surfaces_left_out(totals));
  checks.push_back(momentum_closed(totals));
  checks.push_back(mass_closed(totals, simulation.world()));
  if (a.min_emitted)
    checks.push_back(at_least("emitted", static_cast<double>(totals.emitted), *a.min_emitted));
  if (a.min_over_rim)
    checks.push_back(at_least("over_rim", static_cast<double>(measured.over_rim.size()), *a.min_over_rim));
  if (a.vertical_momentum) checks.push_back(vertical_momentum(scene, totals, measured, simulation.world()));
  if (a.sag_below_dry) checks.push_back(sag_below_dry(scene, measured, totals.steps, options));
  if (a.max_stretch) checks.push_back(at_most("stretch", measured.largest_stretch, *a.max_stretch));
  if (a.slip_ratio) checks.push_back(slip_ratio(scene, measured));
  if (a.pin_reaction) checks.push_back(pin_reaction(scene, measured));
  if (a.dry_shadow) checks.push_back(at_most("in_shadow", static_cast<double>(measured.in_shadow), 0));
  return checks;
}

}  // namespace oilskin::demo
