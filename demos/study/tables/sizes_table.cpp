/// What a step costs over the number of particles, of faces, and of contacts.
#include <cmath>
#include <cstdio>

#include "checks/totals.h"
#include "run/run_report.h"
#include "study/cases/parts.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

constexpr double spacing = 0.005;  // [m]

/// A cube of about `particles` that collapses in a tank of twice its length.
Scene dam_of(double particles) {
  const double edge = spacing * std::round(std::cbrt(particles));
  Scene scene = empty_scene(spacing, 1);
  scene.contact.verify = false;
  scene.emitters = {water_box(Vec3::Zero(), Vec3::Constant(edge))};
  scene.bodies = {tank_body(Vec3::Zero(), Vec3(2 * edge, 2 * edge, edge))};
  return scene;
}

/// A block of 8,000 particles that lies on a sheet of about `faces` triangles.
Scene sheet_of(double faces) {
  const int cells = static_cast<int>(std::round(std::sqrt(faces / 2)));
  Scene scene = empty_scene(spacing, 1);
  scene.contact.verify = false;
  scene.bodies = {
      mesh_body(sheet_mesh(Vec3(-0.25, 0, -0.25), Vec3(0, 0, 0.5), Vec3(0.5, 0, 0), cells, cells))};
  scene.emitters = {water_box(Vec3(-0.05, 0.002, -0.05), Vec3(0.05, 0.102, 0.05))};
  return scene;
}

/// About 8,000 particles in `layers` layers on a sheet of 9,800 triangles, 0.5 m × 0.5 m, that contact alone
/// carries: the first layer starts at the thickness of the sheet.
Scene layers_of(int layers) {
  const double half = 0.5 * spacing * std::round(std::sqrt(8000. / layers));
  const double low = default_thickness(spacing) - 0.5 * spacing;
  Scene scene = empty_scene(spacing, 1);
  scene.contact.verify = false;
  scene.fluid.boundary = BoundaryModel::contact_only;
  scene.bodies = {mesh_body(sheet_mesh(Vec3(-0.25, 0, -0.25), Vec3(0, 0, 0.5), Vec3(0.5, 0, 0), 70, 70))};
  scene.emitters = {water_box(Vec3(-half, low, -half), Vec3(half, low + layers * spacing, half))};
  return scene;
}

std::string row_of(const std::string& kind, const Scene& scene, const TablePlace& place) {
  SimulationOptions options;
  options.threads = place.threads;
  const std::unique_ptr<Simulation> simulation = place.make_simulation(scene, options);
  constexpr int warm = 5, measured = 15;  // steps
  Totals totals;
  double host = 0;
  for (int k = 0; k < warm + measured; ++k) {
    if (k == warm) host = simulation->host_seconds();
    const StepReport& report = simulation->step(scene.dt);
    if (k >= warm) totals.add(report);
  }
  const StageSeconds& s = totals.seconds;
  const double fluid = s.neighbours + s.pressure + s.other_fluid, walls = s.boundary + s.occlusion,
               contact = s.gather + s.proximity + s.impulses + s.ccd + s.zones;
  const double ms = 1e3 / measured, steps = measured;
  char text[220];
  std::snprintf(text, sizeof text, "%s,%zu,%zu,%.4g,%.4g,%.4g,%.4g,%.4g,%.3g,%.2f,%.0f", kind.c_str(),
                simulation->world().particle_count(), simulation->body(0)->triangles.size(),
                ms * (fluid + walls + contact), ms * fluid, ms * walls, ms * contact,
                ms * (simulation->host_seconds() - host), double(totals.substeps) / steps,
                double(totals.pressure_iterations) / double(totals.substeps),
                double(totals.contact.contacts) / double(totals.substeps));
  return text;
}

}  // namespace

StudyTable sizes_table() {
  const auto make = [](const TablePlace& place) {
    std::vector<TableRow> rows;
    for (const double particles : {5e3, 1e4, 2e4, 5e4, 1e5, 2e5, 5e5})
      rows.push_back({"particles " + std::to_string(static_cast<int>(particles)),
                      [=, &place] { return row_of("particles", dam_of(particles), place); }});
    for (const double faces : {1e3, 3e3, 1e4, 3e4, 1e5})
      rows.push_back({"faces " + std::to_string(static_cast<int>(faces)),
                      [=, &place] { return row_of("faces", sheet_of(faces), place); }});
    for (const int layers : {1, 2, 4, 8, 20})
      rows.push_back({"layers " + std::to_string(layers),
                      [=, &place] { return row_of("contacts", layers_of(layers), place); }});
    return rows_of_table(
        "sizes",
        "varied,particles,faces,ms_per_step,ms_fluid,ms_walls,ms_contact,ms_host,substeps_per_step,"
        "iterations_per_substep,contacts_per_substep",
        rows, place);
  };
  return {"sizes", "milliseconds a step over the number of particles, of faces, and of contacts", make};
}

}  // namespace oilskin::demo
