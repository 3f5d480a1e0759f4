/// A box that falls into water: what it makes of energy, over the step and the ratio of the masses.
#include <cmath>
#include <cstdio>

#include "checks/totals.h"
#include "study/cases/parts.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

constexpr double duration = 0.4;            // [s]
constexpr double spacing = 0.01;            // [m]
constexpr double half = 3 * spacing;        // of the edge of the cube
constexpr double depth = 0.1, drop = 0.02;  // of the water, and of the cube's floor above it [m]

Scene scene_of(double dt, double density) {
  Scene scene = empty_scene(spacing, duration);
  scene.host = HostKind::bullet;
  scene.dt = dt;
  scene.emitters = {water_box(Vec3(-0.08, 0, -0.08), Vec3(0.08, depth, 0.08))};
  Body cube;
  cube.shape = BoxShape{Vec3(0, depth + drop + half, 0), Vec3::Constant(half), {0, 0, 0, 1}};
  cube.density = density;
  cube.surface.thickness = 0.2 * spacing;
  scene.bodies = {tank_body(Vec3(-0.08, 0, -0.08), Vec3(0.08, 0.3, 0.08)), cube};
  return scene;
}

std::string row_of(double dt, double ratio, const TablePlace& place) {
  const Scene scene = scene_of(dt, ratio * water_density);
  SimulationOptions options;
  options.threads = place.threads;
  const std::unique_ptr<Simulation> simulation = place.make_simulation(scene, options);
  Totals totals;
  double fastest_water = 0, fastest_body = 0;
  bool refused = false;
  const int steps = static_cast<int>(std::ceil(duration / dt - 1e-9));
  for (int k = 0; k < steps && !refused; ++k) {
    const StepReport& report = simulation->step(dt);
    refused = !report.status.ok();
    if (refused) break;
    totals.add(report);
    fastest_water = std::max(fastest_water, largest_speed(simulation->world()));
    if (const SurfaceMotion* motion = simulation->body(1); motion && motion->body)
      fastest_body = std::max(fastest_body, (motion->body->center_t1 - motion->body->center_t0).norm() / dt);
  }
  char text[200];
  std::snprintf(text, sizeof text, "%g,%g,%.4g,%.4g,%.4g,%llu,%llu,%.4g,%.4g,%s", dt, ratio,
                ratio * std::pow(2 * half / spacing, 3), totals.max_made_fraction, totals.max_risen_fraction,
                static_cast<unsigned long long>(totals.contact.crossings_found_by_verify),
                static_cast<unsigned long long>(totals.contact.removed), fastest_water, fastest_body,
                refused ? "refused" : "");
  return text;
}

}  // namespace

StudyTable floating_table() {
  const auto make = [](const TablePlace& place) {
    std::vector<TableRow> rows;
    for (const double dt : {5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1. / 60})
      for (const double ratio : {0.001, 0.01, 0.1, 0.5, 0.9, 2., 10., 1000.}) {
        char key[60];
        std::snprintf(key, sizeof key, "%g %g", dt, ratio);
        rows.push_back({key, [=, &place] { return row_of(dt, ratio, place); }});
      }
    return rows_of_table(
        "floating",
        "step,density_ratio,body_over_particle_mass,energy_made,energy_risen,crossings,removed,"
        "largest_speed,largest_speed_of_body,refused",
        rows, place);
  };
  return {"floating", "energy made by a box that falls into water, over step and density", make};
}

}  // namespace oilskin::demo
