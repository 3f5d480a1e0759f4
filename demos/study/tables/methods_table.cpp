/// Accuracy and cost of each method: a column at rest and a dam that breaks, over spacing and step.
#include <cstdio>

#include "study/comparators/water_cases.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

std::string column_row(const study::ColumnCase& c) {
  const study::ColumnResult r = study::run(c);
  char text[300];
  std::snprintf(text, sizeof text, "column,%s,%g,5,%.4g,%.4g,%.4g,%.4g,%.4g,%llu,%zu,%zu,%.4g",
                study::name_of(c.method), c.dt, r.level_error, r.pressure_error, r.rms_speed,
                r.force_over_weight - 1, r.density - 1, static_cast<unsigned long long>(r.leaks.particles),
                r.particles, r.remaining, r.seconds_per_second);
  return text;
}

std::string dam_row(const study::DamCase& c) {
  const study::DamResult r = study::run(c);
  char text[300];
  std::snprintf(text, sizeof text, "dam,%s,%g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%llu,%zu,%zu,%.4g",
                study::name_of(c.method), c.dt, 1e3 * c.spacing, r.front_error, r.front_lead, r.energy_gain,
                r.largest_density - 1, r.density_error, static_cast<unsigned long long>(r.leaks.particles),
                r.particles, r.remaining, r.seconds_per_second);
  return text;
}

std::string key_of(const char* kind, study::Method method, double dt, double spacing) {
  char key[120];
  std::snprintf(key, sizeof key, "%s %s %g %g", kind, study::name_of(method), dt, spacing);
  return key;
}

std::vector<TableRow> rows_of(study::Method method) {
  std::vector<TableRow> rows;
  for (const double dt : {0.5e-3, 1e-3, 2e-3, 4e-3}) {
    study::ColumnCase c;
    c.method = method, c.dt = dt;
    rows.push_back({key_of("column", method, dt, 5), [c] { return column_row(c); }});
  }
  for (const double across : {8., 11., 16.})
    for (const double share : {0.1, 0.2, 0.4}) {
      study::DamCase c;
      c.method = method, c.spacing = 0.05715 / across, c.dt = share * c.spacing;
      rows.push_back({key_of("dam", method, c.dt, c.spacing), [c] { return dam_row(c); }});
    }
  return rows;
}

}  // namespace

StudyTable methods_table() {
  const auto make = [](const TablePlace& place) {
    std::vector<TableRow> rows;
    for (const study::Method method : study::all_methods)
      for (TableRow& row : rows_of(method)) rows.push_back(std::move(row));
    // Column: level, rms pressure, rms speed [m/s], force, density. Dam: front, lead, energy gained, densest
    // tenth, mean compression. All but the speed are relative.
    return rows_of_table("methods",
                         "case,method,step,spacing_mm,level_or_front,pressure_or_lead,speed_or_energy,"
                         "force_or_densest,density,leaked,particles,remaining,seconds_per_simulated_second",
                         rows, place);
  };
  return {"methods", "accuracy and cost of published methods: column at rest, dam break", make};
}

}  // namespace oilskin::demo
