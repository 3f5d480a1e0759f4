#include "run/run_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "output/write_file.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

Json vec(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

std::string instruction_set() {
#if defined(__x86_64__)
  return std::string("x86-64 ") + World::instruction_set();
#elif defined(__aarch64__)
  return "AArch64";
#else
  return "generic";
#endif
}

const char* compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "gcc " __VERSION__;
#else
  return "unknown";
#endif
}

Json machine(const RunSummary& s) {
  Json machine = machine_of(s.threads);
  machine["precision"] = s.simulation.precision();
  return machine;
}

/// Reading and writing the host's surfaces is counted as cloth.
Json seconds(const RunSummary& s) {
  const StageSeconds& t = s.totals.seconds;
  return {{"cloth", s.simulation.host_seconds() + t.gather},
          {"neighbours", t.neighbours},
          {"occlusion", t.occlusion},
          {"boundary", t.boundary},
          {"pressure", t.pressure},
          {"other_fluid", t.other_fluid},
          {"proximity", t.proximity},
          {"impulses", t.impulses},
          {"ccd", t.ccd},
          {"zones", t.zones},
          {"effects", t.effects},
          {"surface", s.meshes.seconds},
          {"output", s.output_seconds},
          {"verify", t.verify}};
}

/// The smallest δ of all surfaces: the limit of min_distance.
double min_delta(const RunSummary& s) {
  double minimum = std::numeric_limits<double>::infinity();
  auto look = [&](const SurfaceMotion* motion) {
    if (motion != nullptr) minimum = std::min(minimum, motion->delta);
  };
  for (std::size_t i = 0; i < s.scene.cloth.size(); ++i) look(s.simulation.cloth(i));
  for (std::size_t i = 0; i < s.scene.bodies.size(); ++i) look(s.simulation.body(i));
  return minimum;
}

Json contact(const RunSummary& s) {
  const ContactReport& c = s.totals.contact;
  return {{"candidates", c.candidates},
          {"contacts", c.contacts},
          {"meetings", c.impacts},
          {"zone_rounds", c.zone_rounds},
          {"held", c.held},
          {"nudged", c.separated},
          {"stalled", c.stalled},
          {"removed", c.removed},
          {"allowed", c.allowed},
          {"delta", min_delta(s)},
          {"least_distance", c.min_distance},
          {"crossings_found_by_verify", c.crossings_found_by_verify},
          {"followed", c.carried_along},
          {"reseeded", c.relocated},
          {"verified_pairs", c.verified_pairs}};
}

Json surface(const MeshTotals& s) {
  return {{"frames", s.frames},
          {"triangles", s.triangles},
          {"intersecting_pairs", s.intersecting_pairs},
          {"nearer_than_gap", s.too_close_pairs},
          {"submerged", s.submerged},
          {"flaws", s.flaws},
          {"least_distance", s.min_distance},
          {"seconds", s.seconds}};
}

Json momentum(const RunSummary& s) {
  const Totals& t = s.totals;
  return {{"emitted", vec(t.momentum_emitted)},
          {"removed", vec(t.momentum_removed)},
          {"gravity", vec(t.momentum_gravity)},
          {"to_free_nodes", vec(t.contact.impulse_on_free_nodes)},
          {"to_prescribed_nodes", vec(t.contact.impulse_on_prescribed)},
          {"to_bodies", vec(t.contact.impulse_on_bodies)},
          {"fluid", vec(fluid_momentum(s.simulation.world()))},
          {"residual", vec(t.momentum_residual)},
          {"scale", t.momentum_scale}};
}

Json energy(const RunSummary& s) {
  const EnergyReport& e = s.totals.energy;
  return {{"water_kinetic", e.water_kinetic},
          {"water_potential", e.water_potential},
          {"node_kinetic", e.node_kinetic},
          {"node_potential", e.node_potential},
          {"transfer", e.transfer},
          {"entered_kinetic", e.entered_kinetic},
          {"entered_potential", e.entered_potential},
          {"left_kinetic", e.left_kinetic},
          {"left_potential", e.left_potential},
          {"work_prescribed", e.work_prescribed},
          {"work_host", e.work_host},
          {"work_outside", e.work_outside},
          {"released_potential", e.released_potential},
          {"made", e.made},
          {"scale", e.scale},
          {"max_made_fraction", s.totals.max_made_fraction},
          {"max_risen_fraction", s.totals.max_risen_fraction},
          {"rms_speed", e.rms_speed},
          {"max_speed", e.max_speed}};
}

Json mass(const RunSummary& s) {
  const World& world = s.simulation.world();
  const Totals& t = s.totals;
  return {{"particle", world.particle_mass()},
          {"emitted", t.mass_emitted},
          {"alive", world.fluid_mass()},
          {"removed", t.mass_removed},
          {"absorbed", t.mass_absorbed},
          {"released", t.mass_released},
          {"dried", t.mass_dried},
          {"lost_with_meshes", t.mass_lost},
          {"in_cloth", world.absorbed_mass()},
          {"residual", t.mass_in_fluid() - world.fluid_mass()},
          {"residual_in_cloth", t.mass_in_cloth() - world.absorbed_mass()}};
}

Json acceptance(const RunSummary& s) {
  Json checks = Json::array();
  for (const CheckResult& c : s.checks)
    checks.push_back({{"name", c.name}, {"value", c.value}, {"limit", c.limit}, {"ok", c.ok}});
  return checks;
}

std::string hexadecimal(std::uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

}  // namespace

Json machine_of(int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return {{"cores", cores},
          {"threads", threads > 0 ? threads : cores},
          {"compiler", compiler()},
          {"instruction_set", instruction_set()}};
}

std::uint64_t peak_memory_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Json make_report(const RunSummary& s) {
  const Totals& t = s.totals;
  const double steps = static_cast<double>(std::max<std::uint64_t>(1, t.steps));
  Json report;
  report["scene"] = s.scene.name;
  report["settings"] = resolved_scene(s.scene, s.acceptance);
  report["machine"] = machine(s);
  report["steps"] = t.steps;
  report["substeps"] = t.substeps;
  report["simulated_seconds"] = t.simulated;
  report["wall_seconds"] = s.wall_seconds;
  report["cpu_seconds"] = s.cpu_seconds;
  report["seconds"] = seconds(s);
  report["particles"] = {{"emitted", t.emitted},
                         {"alive", s.simulation.world().particle_count()},
                         {"removed", t.removed},
                         {"removed_by_sinks", t.removed_by_sinks},
                         {"removed_by_age", t.removed_by_age},
                         {"removed_too_fast", t.removed_too_fast},
                         {"absorbed", t.absorbed},
                         {"released", t.released},
                         {"blocked_starts", t.blocked_starts},
                         {"limited_starts", t.limited_starts}};
  report["contact"] = contact(s);
  if (s.scene.water_mesh) report["surface"] = surface(s.meshes);
  report["density_error"] = {{"mean", t.density_error_sum / steps}, {"max", t.density_error_max}};
  report["pressure_iterations"] = static_cast<double>(t.pressure_iterations) / steps;
  report["momentum"] = momentum(s);
  report["mass"] = mass(s);
  report["energy"] = energy(s);
  report["state_hash"] = hexadecimal(s.simulation.world().state_hash());
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["resident_memory_bytes"] = {{"after_a_fifth", s.memory.after_a_fifth()},
                                     {"at_end", s.memory.at_end()}};
  report["acceptance"] = acceptance(s);
  report["flags"] = flag_texts(t.flags);
  report["messages"] = s.scene.notes;
  for (const std::string& message : t.messages) report["messages"].push_back(message);
  if (!t.energy_message.empty()) report["messages"].push_back(t.energy_message);
  if (s.signal != 0) report["stopped_by_signal"] = s.signal;
  return report;
}

void write_report(const Json& report, const std::string& directory) {
  write_file(directory + "/report.json", report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace oilskin::demo
