// Prints what the methods do: `print_comparator_tables TABLE [METHOD …]`. Tables: all, border, none (leaks of
// a sheet of which so many nodes are held), column, dam.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "study/comparators/leak_table.h"
#include "study/comparators/water_cases.h"

using namespace oilskin::study;

namespace {

const char* name_of(Held held) {
  return held == Held::all ? "all" : held == Held::border ? "border" : "none";
}

void print(const LeakResult& r) {
  std::printf("%-18s %-6s %6.1f %8.3f %6zu %6zu %8llu %6llu %6llu %6llu %9.2f %s\n", name_of(r.setup.method),
              name_of(r.setup.held), r.setup.speed, 1e3 * r.setup.dt, r.particles, r.remaining,
              static_cast<unsigned long long>(r.leaks.passages),
              static_cast<unsigned long long>(r.leaks.particles),
              static_cast<unsigned long long>(r.leaks.beyond), static_cast<unsigned long long>(r.intervals),
              r.seconds_per_second, r.refused.c_str());
  std::fflush(stdout);
}

void print(const ColumnResult& r) {
  std::printf(
      "%-18s %8.3f F/W %7.4f level %+7.4f first %5.2f p rms %7.4f slope %6.3f rho %6.4f rms v %8.5f "
      "leaks %llu (%zu of %zu left) %8.2f s/s\n",
      name_of(r.setup.method), 1e3 * r.setup.dt, r.force_over_weight, r.level_error, r.first_layer,
      r.pressure_error, r.pressure_slope, r.density, r.rms_speed,
      static_cast<unsigned long long>(r.leaks.particles), r.remaining, r.particles, r.seconds_per_second);
  std::fflush(stdout);
}

void print(const DamResult& r) {
  std::printf(
      "%-18s %8.3f Z error %6.3f lead %+7.3f compression %7.4f densest %6.3f energy %+7.4f leaks %llu "
      "(%zu of %zu left) %8.2f s/s\n",
      name_of(r.setup.method), 1e3 * r.setup.dt, r.front_error, r.front_lead, r.density_error,
      r.largest_density, r.energy_gain, static_cast<unsigned long long>(r.leaks.particles), r.remaining,
      r.particles, r.seconds_per_second);
  std::fflush(stdout);
}

bool wanted(Method method, int argc, char** argv) {
  return argc < 3 || std::any_of(argv + 2, argv + argc,
                                 [&](const char* name) { return std::strcmp(name, name_of(method)) == 0; });
}

}  // namespace

int main(int argc, char** argv) {
  const char* table = argc > 1 ? argv[1] : "column";
  for (const LeakCase& c : leak_cases())
    if (wanted(c.method, argc, argv) && std::strcmp(table, name_of(c.held)) == 0) print(run(c));
  for (Method method : all_methods) {
    if (!wanted(method, argc, argv)) continue;
    for (double dt : {0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3}) {
      ColumnCase column;
      DamCase dam;
      column.method = dam.method = method, column.dt = dam.dt = dt;
      if (std::strcmp(table, "column") == 0) print(run(column));
      if (std::strcmp(table, "dam") == 0) print(run(dam));
    }
  }
}
