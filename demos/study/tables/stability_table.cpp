/// Where water on light cloth makes energy, and where the host's cloth gives up by itself.
#include <cmath>
#include <cstdio>

#include "checks/totals.h"
#include "study/cases/parts.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

constexpr double duration = 0.2;  // [s]

Scene scene_of(double dt, double areal_density) {
  Scene scene = empty_scene(0.005, duration);
  scene.host = HostKind::bullet;
  scene.dt = dt;
  Cloth cloth;
  cloth.grid = {25, 25};
  cloth.size = {0.3, 0.3};
  cloth.areal_density = areal_density;
  cloth.pins.kind = PinKind::corners;
  scene.cloth = {cloth};
  DiscEmitter nozzle;
  nozzle.center = Vec3(0, 0.03, 0);
  nozzle.radius = 0.015;
  nozzle.speed = 1.5;
  scene.emitters = {nozzle};
  return scene;
}

/// The largest length of a link over its rest length, less 1.
double stretch_of(const Simulation& simulation) {
  const SurfaceMotion* motion = simulation.cloth(0);
  if (motion == nullptr) return never;
  const ClothModel& model = simulation.models()[0];
  double largest = 0;
  for (const auto& [a, b] : model.links) {
    const double rest = (model.rest[a] - model.rest[b]).norm();
    largest = std::max(largest, (motion->x_t1[a] - motion->x_t1[b]).norm() / rest - 1);
  }
  return largest;
}

struct Outcome {
  Totals totals;
  double stretch = 0, speed = 0;
  std::string refused;
};

Outcome run(const Scene& scene, bool wet, const TablePlace& place) {
  SimulationOptions options;
  options.threads = place.threads;
  options.emitters = wet;
  const std::unique_ptr<Simulation> simulation = place.make_simulation(scene, options);
  Outcome outcome;
  const int steps = static_cast<int>(std::ceil(duration / scene.dt - 1e-9));
  for (int k = 0; k < steps; ++k) {
    const StepReport& report = simulation->step(scene.dt);
    if (!report.status.ok()) {
      outcome.refused = report.status.message;
      break;
    }
    outcome.totals.add(report);
    outcome.stretch = std::max(outcome.stretch, stretch_of(*simulation));
    outcome.speed = std::max(outcome.speed, largest_speed(simulation->world()));
  }
  return outcome;
}

std::string row_of(double dt, double areal_density, const TablePlace& place) {
  const Scene scene = scene_of(dt, areal_density);
  const Outcome wet = run(scene, true, place), dry = run(scene, false, place);
  const double node = areal_density * 0.3 * 0.3 / (25 * 25);
  char text[240];
  std::snprintf(text, sizeof text, "%g,%g,%.4g,%.4g,%.4g,%llu,%.4g,%.4g,%.4g,%s", dt, areal_density,
                water_density * std::pow(0.005, 3) / node, wet.totals.max_made_fraction,
                wet.totals.max_risen_fraction,
                static_cast<unsigned long long>(wet.totals.contact.crossings_found_by_verify), wet.speed,
                wet.stretch, dry.stretch, wet.refused.empty() ? "" : "refused");
  return text;
}

}  // namespace

StudyTable stability_table() {
  const auto make = [](const TablePlace& place) {
    std::vector<TableRow> rows;
    for (const double dt : {5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1. / 60})
      for (const double density : {0.02, 0.05, 0.1, 0.2, 0.5, 1., 2.}) {
        char key[60];
        std::snprintf(key, sizeof key, "%g %g", dt, density);
        rows.push_back({key, [=, &place] { return row_of(dt, density, place); }});
      }
    return rows_of_table(
        "stability",
        "step,areal_density,particle_over_node_mass,energy_made,energy_risen,crossings,largest_speed,"
        "stretch,stretch_of_dry_cloth,refused",
        rows, place);
  };
  return {"stability", "energy made by a jet on Bullet's cloth, over step and areal density", make};
}

}  // namespace oilskin::demo
