#include "study/run/case_report.h"

#include <cmath>

#include "study/run/table_text.h"

namespace oilskin::demo {
namespace {

std::string plain(double value) {
  return std::isfinite(value) ? format_number("%.9g", value) : "";
}

std::string in_quotes(const std::string& text) {
  return "\"" + text + "\"";
}

std::string row(const CaseLevels& levels, const CaseRun& run, const Quantity& q) {
  const CaseCost& c = run.cost;
  std::string text = run.name + "," + plain(run.spacing) + "," + in_quotes(q.name);
  for (const double value : {q.value, q.reference, q.error(), q.uncertainty, tolerance_at(levels.of, run, q)})
    text += "," + plain(value);
  text += std::string(",") + verdict(levels.of, run, q);
  for (const double value : {c.seconds_per_simulated_second().median, c.simulated_seconds, double(c.steps),
                             double(c.substeps), double(c.particles), double(c.faces), double(run.crossings)})
    text += "," + plain(value);
  return text + "\n";
}

std::string levels_head(const CaseLevels& levels) {
  std::string head = "| quantity | reference |", rule = "|---|---|";
  for (const CaseRun& run : levels.runs) {
    head += " " + format_number("%.4g mm", 1e3 * run.spacing) + " |";
    rule += "---|";
  }
  return head + " tolerance | order |\n" + rule + "---|---|\n";
}

std::string levels_row(const CaseLevels& levels, std::size_t k) {
  const Quantity& q = levels.runs.back().quantities[k];
  std::string text = "| " + q.name + " | " + format_number("%.4g", q.reference) + " |";
  for (const CaseRun& run : levels.runs) {
    const bool there = k < run.quantities.size();
    const bool missed = there && std::string(verdict(levels.of, run, run.quantities[k])) == "MISSED";
    const std::string value = there ? format_number("%.4g", run.quantities[k].value) : "failed";
    text += missed ? " **" + value + "** |" : " " + value + " |";
  }
  const auto order = observed_order(levels, q.name);
  return text + " " + format_number("%.2g", q.tolerance) + " | " +
         (order ? format_number("%.1f", *order) : "–") + " |\n";
}

std::string costs_row(const CaseLevels& levels) {
  std::string text = "| seconds per simulated second | |";
  for (const CaseRun& run : levels.runs)
    text += " " + format_number("%.3g", run.cost.seconds_per_simulated_second().median) + " |";
  text += " | |\n| particles | |";
  for (const CaseRun& run : levels.runs) text += " " + std::to_string(run.cost.particles) + " |";
  return text + " | |\n";
}

std::string failures(const CaseLevels& levels) {
  std::string text;
  for (const CaseRun& run : levels.runs) {
    const std::string at = "At " + format_number("%.4g mm", 1e3 * run.spacing) + ": ";
    if (!run.failure.empty()) text += "\n" + at + run.failure + "\n";
    if (run.crossings > 0) text += "\n" + at + std::to_string(run.crossings) + " crossings.\n";
  }
  return text;
}

std::string section(const CaseLevels& levels) {
  std::string text = "\n## " + levels.of.name + "\n\n" + levels.of.title +
                     ". Reference: " + levels.of.reference + ".\n\n" + levels_head(levels);
  for (std::size_t k = 0; k < levels.runs.back().quantities.size(); ++k) text += levels_row(levels, k);
  return text + costs_row(levels) + failures(levels);
}

}  // namespace

std::string validation_csv(const std::vector<CaseLevels>& results) {
  std::string text =
      "case,spacing,quantity,value,reference,error,uncertainty,tolerance,verdict,seconds_per_simulated_"
      "second,"
      "simulated_seconds,steps,substeps,particles,faces,crossings\n";
  for (const CaseLevels& levels : results)
    for (const CaseRun& run : levels.runs)
      for (const Quantity& q : run.quantities) text += row(levels, run, q);
  return text;
}

std::string validation_markdown(const std::vector<CaseLevels>& results, const Json& machine) {
  std::string text =
      "# Validation\n\nAn error is |value − reference| over |reference|, or over the scale that the quantity "
      "names. The tolerance is that at the finest spacing; values in bold miss it. The order is the slope of "
      "log(error) over log(spacing); there is none where an error is within the uncertainty of the "
      "reference.\n\n" +
      machine_line(machine) + "\n";
  for (const CaseLevels& levels : results) text += section(levels);
  return text;
}

}  // namespace oilskin::demo
