#include "study/run/study_table.h"

#include <algorithm>
#include <cmath>

#include "study/run/table_text.h"

namespace oilskin::demo {
namespace {

double cost_of(const StudyRow& row) {
  return row.run.cost.seconds_per_simulated_second().median;
}

bool counts(const StudyRow& row) {
  return row.run.failure.empty() && row.run.crossings == 0 && std::isfinite(row.error());
}

/// Better in one and not worse in the other.
bool beats(const StudyRow& a, const StudyRow& b) {
  return a.error() <= b.error() && cost_of(a) <= cost_of(b) &&
         (a.error() < b.error() || cost_of(a) < cost_of(b));
}

std::string state_of(const StudyRow& row) {
  if (!row.run.failure.empty()) return "failed: " + row.run.failure;
  if (row.run.crossings > 0) return std::to_string(row.run.crossings) + " crossings";
  return row.on_front ? "front" : "";
}

std::string table_row(const StudyRow& row) {
  const Spread cost = row.run.cost.seconds_per_simulated_second();
  return "| " + row.sweep + " | " + row.label + " | " + format_number("%.4g", 1e3 * row.run.spacing) + " | " +
         format_number("%.3g %%", 100 * row.error()) + " | " + format_number("%.3g", cost.median) + " (" +
         format_number("%.3g", cost.min) + "–" + format_number("%.3g", cost.max) + ") | " +
         format_number("%.2g %%", 100 * row.run.density_error_mean) + " | " +
         format_number("%.2g %%", 100 * row.run.energy_made_fraction) + " | " + state_of(row) + " |\n";
}

}  // namespace

double StudyRow::error() const {
  for (const Quantity& q : run.quantities)
    if (q.name == quantity) return q.error();
  return never;
}

void mark_pareto_front(std::vector<StudyRow>& rows) {
  for (StudyRow& row : rows)
    row.on_front = counts(row) && std::none_of(rows.begin(), rows.end(), [&](const StudyRow& other) {
                     return other.run.name == row.run.name && counts(other) && beats(other, row);
                   });
}

std::string study_csv(const std::vector<StudyRow>& rows) {
  std::string text =
      "case,sweep,label,spacing,quantity,error,seconds_per_simulated_second,least,largest,steps,substeps,"
      "particles,faces,density_error,energy_made,crossings,peak_memory,front,failure\n";
  for (const StudyRow& row : rows) {
    const CaseCost& c = row.run.cost;
    const Spread cost = c.seconds_per_simulated_second();
    text += row.run.name + "," + row.sweep + "," + row.label + "," + format_number("%.9g", row.run.spacing) +
            ",\"" + row.quantity + "\"," +
            (std::isfinite(row.error()) ? format_number("%.9g", row.error()) : "");
    for (const double value : {cost.median, cost.min, cost.max, double(c.steps), double(c.substeps),
                               double(c.particles), double(c.faces), row.run.density_error_mean,
                               row.run.energy_made_fraction, double(row.run.crossings), c.peak_memory})
      text += "," + format_number("%.9g", value);
    text += std::string(row.on_front ? ",1,\"" : ",0,\"") + row.run.failure + "\"\n";
  }
  return text;
}

std::string study_markdown(const std::vector<StudyRow>& rows, const Json& machine) {
  std::string text =
      "# What accuracy costs\n\nOne parameter is varied at a time. Cost: wall seconds per simulated second, "
      "median (least–largest) of the repetitions. Front: no other row of the case has a smaller error at a "
      "smaller cost. Density: mean compression. Energy: what was made, over the scale of the "
      "case.\n\n" +
      machine_line(machine) + "\n";
  for (const StudiedCase& studied : studied_cases()) {
    text += "\n## " + studied.name + "\n\nError: " + studied.quantity +
            ".\n\n| parameter | value | spacing [mm] | error | cost | density | energy | "
            "|\n|---|---|---|---|---|---|---|---|\n";
    for (const StudyRow& row : rows)
      if (row.run.name == studied.name) text += table_row(row);
  }
  return text;
}

}  // namespace oilskin::demo
