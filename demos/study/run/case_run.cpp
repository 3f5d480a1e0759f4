#include "study/run/case_run.h"

#include <chrono>

#include "oilskin/presets.h"
#include "run/run_report.h"
#include "run/signals.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

using Names = std::vector<std::pair<const char*, int>>;
const Names hosts = {
    {"mock", int(HostKind::mock)}, {"bullet", int(HostKind::bullet)}, {"bullet64", int(HostKind::bullet64)}};
const Names presets = {{"none", int(PresetKind::none)},
                       {"game", int(PresetKind::game)},
                       {"film", int(PresetKind::film)},
                       {"measurement", int(PresetKind::measurement)}};

int value_of(const Names& names, const std::string& word, const std::string& key) {
  std::string all;
  for (const auto& [name, value] : names) {
    if (word == name) return value;
    all += (all.empty() ? "" : ", ") + std::string(name);
  }
  throw SceneError(key + ": is \"" + word + "\", must be one of " + all);
}

std::string name_of(const Names& names, int value) {
  for (const auto& [name, known] : names)
    if (value == known) return name;
  return "";
}

void apply_preset(Scene& scene, PresetKind kind) {
  const double spacing = scene.fluid.spacing;
  const Preset preset = kind == PresetKind::game   ? game_preset(spacing)
                        : kind == PresetKind::film ? film_preset(spacing)
                                                   : measurement_preset(spacing);
  const FluidSettings own = scene.fluid;
  scene.dt = preset.dt;
  scene.fluid = preset.fluid;
  scene.fluid.rest_density = own.rest_density;
  scene.fluid.viscosity = own.viscosity;
  scene.fluid.xsph_rate = own.xsph_rate;
  scene.contact = preset.contact;
  scene.contact.verify = true;
}

/// Surfaces and emitters of a case are not in files: they stay out of the JSON.
void apply_assignments(Scene& scene, const std::vector<std::string>& set) {
  if (set.empty()) return;
  Scene rest = scene;
  rest.cloth.clear();
  rest.bodies.clear();
  rest.emitters.clear();
  Json json = write_scene(rest);
  for (const std::string& assignment : set) {
    for (const char* list : {"cloth", "bodies", "emitters"})
      if (assignment.rfind(list, 0) == 0)
        throw SceneError("--set " + assignment + ": a case keeps its " + list);
    apply_override(json, assignment);
  }
  rest = read_scene(json, "");
  rest.cloth = std::move(scene.cloth);
  rest.bodies = std::move(scene.bodies);
  rest.emitters = std::move(scene.emitters);
  scene = std::move(rest);
}

std::uint64_t faces_of(const Scene& scene, const Simulation& simulation) {
  std::uint64_t faces = 0;
  const auto count = [&](const SurfaceMotion* m) { faces += m == nullptr ? 0 : m->triangles.size(); };
  for (std::size_t i = 0; i < scene.cloth.size(); ++i) count(simulation.cloth(i));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) count(simulation.body(i));
  return faces;
}

/// A simulation that runs to its end, its probe, and what is summed.
class Execution {
 public:
  Execution(const Scene& scene, Simulation& simulation, Probe& probe)
      : scene_(scene), simulation_(simulation), probe_(probe), plan_(scene) {}

  void run(CaseRun& run, const CaseProgress& progress) {
    while (!plan_.done(simulation_.time()) && caught_signal() == 0) {
      if (!step(run)) break;
      progress(plan_.fraction(simulation_.time()));
    }
    run.signal = caught_signal();
    if (run.signal == 0 && run.failure.empty()) run.quantities = probe_.quantities(moment());
    finish(run);
  }

 private:
  Moment moment() { return {scene_, simulation_, dt_, simulation_.time().value(), true, dt_}; }

  bool step(CaseRun& run) {
    const double suggested = plan_.adaptive() ? simulation_.world().suggested_dt(scene_.dt) : scene_.dt;
    dt_ = plan_.next(simulation_.time().value(), suggested);
    const auto start = std::chrono::steady_clock::now();
    const StepReport& report = simulation_.step(dt_);
    wall_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!report.status.ok()) {
      run.failure = report.status.message;
      return false;
    }
    totals_.add(report);
    probe_.after_step(moment());
    return true;
  }

  void finish(CaseRun& run) {
    run.cost.wall_seconds = {wall_ - totals_.seconds.verify};
    run.cost.simulated_seconds = totals_.simulated;
    run.cost.steps = totals_.steps;
    run.cost.substeps = totals_.substeps;
    run.cost.particles = simulation_.world().particle_count();
    run.cost.faces = faces_of(scene_, simulation_);
    run.cost.peak_memory = static_cast<double>(peak_memory_bytes());
    run.crossings = totals_.contact.crossings_found_by_verify;
    run.density_error_mean =
        totals_.density_error_sum / static_cast<double>(std::max<std::uint64_t>(totals_.steps, 1));
    run.energy_made_fraction = totals_.max_made_fraction;
    run.flags = totals_.flags;
  }

  const Scene& scene_;
  Simulation& simulation_;
  Probe& probe_;
  StepPlan plan_;
  Totals totals_;
  double dt_ = 0, wall_ = 0;  // [s]
};

}  // namespace

Spread CaseCost::seconds_per_simulated_second() const {
  std::vector<double> ratios;
  for (const double wall : wall_seconds)
    if (simulated_seconds > 0) ratios.push_back(wall / simulated_seconds);
  return spread_of(ratios);
}

HostKind host_of(const std::string& word) {
  return HostKind(value_of(hosts, word, "--host"));
}

PresetKind preset_of(const std::string& word) {
  return PresetKind(value_of(presets, word, "--preset"));
}

Json to_json(const Variation& v) {
  return {{"step", v.step},
          {"thickness", v.thickness},
          {"host", name_of(hosts, int(v.host))},
          {"preset", name_of(presets, int(v.preset))},
          {"set", v.set}};
}

Scene varied_scene(const ValidationCase& of, double spacing, const Variation& variation) {
  Scene scene = of.scene(spacing);
  scene.name = of.name;
  scene.host = variation.host;
  if (variation.preset != PresetKind::none) apply_preset(scene, variation.preset);
  apply_assignments(scene, variation.set);
  scene.dt *= variation.step;
  if (variation.thickness > 0) {
    for (Cloth& c : scene.cloth) c.surface.thickness = variation.thickness * spacing;
    for (Body& b : scene.bodies) b.surface.thickness = variation.thickness * spacing;
  }
  return scene;
}

CaseRun run_case(const ValidationCase& of, double spacing, const Variation& variation, int threads,
                 const MakeSimulation& make_simulation, const CaseProgress& progress) {
  const Scene scene = varied_scene(of, spacing, variation);
  SimulationOptions options;
  options.threads = threads;
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, options);
  const std::unique_ptr<Probe> probe = of.probe(scene);
  CaseRun run;
  run.name = of.name;
  run.spacing = spacing;
  run.variation = variation;
  Execution(scene, *simulation, *probe).run(run, progress);
  return run;
}

}  // namespace oilskin::demo
