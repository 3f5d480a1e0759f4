/// Leaks over the step, per method and speed.
#include <cmath>
#include <cstdio>

#include "study/comparators/leak_table.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

using study::LeakCase;
using study::LeakResult;

const char* word_of(study::Held held) {
  return held == study::Held::all ? "fixed" : held == study::Held::border ? "held at its border" : "free";
}

/// As published; and for a fixed sheet, where nothing but the length of the step matters, the other methods
/// cut into as many sub-steps as the library is by default.
std::vector<LeakCase> all_cases() {
  std::vector<LeakCase> all = study::leak_cases();
  const std::size_t published = all.size();
  for (std::size_t k = 0; k < published; ++k) {
    LeakCase c = all[k];
    if (c.method == study::Method::oilskin || c.held != study::Held::all || c.speed > 20) continue;
    c.max_substeps = 8;
    all.push_back(c);
  }
  return all;
}

std::string method_of(const LeakCase& c) {
  return study::name_of(c.method) + std::string(c.max_substeps ? ", 8 sub-steps" : "");
}

std::string row_of(const LeakCase& c) {
  const LeakResult r = study::run(c);
  char text[240];
  std::snprintf(text, sizeof text, "\"%s\",%s,%g,%g,%zu,%zu,%llu,%llu,%llu,%.4g,%.4g,%s",
                method_of(c).c_str(), word_of(c.held), c.speed, c.dt, r.particles, r.remaining,
                static_cast<unsigned long long>(r.leaks.passages),
                static_cast<unsigned long long>(r.leaks.particles),
                static_cast<unsigned long long>(r.leaks.beyond),
                static_cast<double>(r.leaks.particles) / static_cast<double>(r.particles),
                r.seconds_per_second, r.refused.empty() ? "" : "refused");
  return text;
}

}  // namespace

StudyTable leaks_table() {
  const auto make = [](const TablePlace& place) {
    std::vector<TableRow> rows;
    for (const LeakCase& c : all_cases()) {
      char key[120];
      std::snprintf(key, sizeof key, "%s %s %g %g", method_of(c).c_str(), word_of(c.held), c.speed, c.dt);
      rows.push_back({key, [c] { return row_of(c); }});
    }
    return rows_of_table("leaks",
                         "method,held,speed,step,particles,remaining,passages,leaked,beyond,leaked_fraction,"
                         "seconds_per_simulated_second,refused",
                         rows, place);
  };
  return {"leaks", "particles of a jet that pass a sheet, over method, step and speed", make};
}

}  // namespace oilskin::demo
