#include "output/effect_table.h"

#include <array>
#include <cstdio>

namespace oilskin::demo {
namespace {

constexpr double mebibyte = 1024 * 1024;  // [bytes]

/// With as many digits as a measurement has.
std::string number(double value, const char* format = "%.6g") {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// One line of a table, cell by cell.
class Row {
 public:
  explicit Row(const char* separator) : separator_(separator) {}

  Row& cell(const std::string& text) {
    line_ += (line_.empty() ? "" : separator_) + text;
    return *this;
  }
  Row& cells(const Spread& s) { return cell(number(s.median)).cell(number(s.min)).cell(number(s.max)); }
  Row& names(const std::string& name) { return cell(name).cell(name + "_min").cell(name + "_max"); }
  const std::string& line() const { return line_; }

 private:
  std::string separator_, line_;
};

std::string csv_names() {
  Row row(",");
  row.cell("configuration").cell("runs");
  for (const char* name : {"wall_seconds", "cpu_seconds", "effects_seconds", "stages_seconds", "wall_ratio",
                           "cpu_ratio", "peak_memory_bytes", "memory_ratio"})
    row.names(name);
  for (const char* name : {"seconds_per_simulated_second", "bytes_per_particle", "added_bytes_per_particle",
                           "steps", "substeps", "particles", "checks_hold"})
    row.cell(name);
  return row.line();
}

std::string csv_row(const EffectCost& cost, const EffectCost& none) {
  const RunCost& first = cost.runs.front();
  Row row(",");
  row.cell(cost.name).cell(std::to_string(cost.runs.size()));
  row.cells(cost.of(&RunCost::wall_seconds)).cells(cost.of(&RunCost::cpu_seconds));
  row.cells(cost.of(&RunCost::effects_seconds)).cells(cost.of(&RunCost::stages_seconds));
  row.cells(cost.ratio(&RunCost::wall_seconds, none)).cells(cost.ratio(&RunCost::cpu_seconds, none));
  row.cells(cost.of(&RunCost::peak_memory)).cells(cost.ratio(&RunCost::peak_memory, none));
  row.cell(number(cost.seconds_per_simulated_second())).cell(number(cost.bytes_per_particle()));
  row.cell(number(cost.added_bytes_per_particle(none)));
  row.cell(std::to_string(first.steps)).cell(std::to_string(first.substeps));
  row.cell(std::to_string(first.particles)).cell(cost.checks_hold() ? "1" : "0");
  return row.line();
}

std::string with_spread(const Spread& s, const char* format) {
  return number(s.median, format) + " (" + number(s.min, format) + "–" + number(s.max, format) + ")";
}

std::string markdown_row(const EffectCost& cost, const EffectCost& none) {
  const RunCost& first = cost.runs.front();
  Row row(" | ");
  row.cell(cost.name);
  row.cell(with_spread(cost.of(&RunCost::wall_seconds), "%.2f"));
  row.cell(with_spread(cost.of(&RunCost::cpu_seconds), "%.2f"));
  row.cell(number(cost.of(&RunCost::effects_seconds).median, "%.2f"));
  row.cell(number(cost.of(&RunCost::stages_seconds).median, "%.2f"));
  row.cell(number(cost.seconds_per_simulated_second(), "%.1f"));
  row.cell(with_spread(cost.ratio(&RunCost::wall_seconds, none), "%.2f"));
  row.cell(with_spread(cost.ratio(&RunCost::cpu_seconds, none), "%.2f"));
  row.cell(number(cost.of(&RunCost::peak_memory).median / mebibyte, "%.1f"));
  row.cell(number(cost.bytes_per_particle(), "%.0f"));
  row.cell(number(cost.added_bytes_per_particle(none), "%.0f"));
  row.cell(number(cost.ratio(&RunCost::peak_memory, none).median, "%.2f"));
  row.cell(std::to_string(first.steps) + " / " + std::to_string(first.substeps));
  row.cell(std::to_string(first.particles));
  return "| " + row.line() + " |";
}

std::string machine_line(const RunCost& run) {
  return std::to_string(run.threads) + " thread" + (run.threads == 1 ? "" : "s") + " on a machine of " +
         std::to_string(run.cores) + " cores, " + run.compiler + ", " + run.instruction_set + ", " +
         run.precision + " precision";
}

std::string failed_lines(const std::vector<EffectCost>& costs) {
  std::string lines;
  for (const EffectCost& cost : costs)
    for (std::size_t k = 0; k < cost.runs.size(); ++k)
      for (const std::string& check : cost.runs[k].failed)
        lines +=
            "- `" + cost.name + "`, run " + std::to_string(k + 1) + ": the check `" + check + "` FAILED.\n";
  return lines;
}

}  // namespace

std::string effects_csv(const std::vector<EffectCost>& costs) {
  std::string text = csv_names() + "\n";
  for (const EffectCost& cost : costs) text += csv_row(cost, costs.front()) + "\n";
  return text;
}

std::string effects_markdown(const EffectsTitle& title, const std::vector<EffectCost>& costs) {
  const RunCost& run = costs.front().runs.front();
  std::string text = "# Cost of effects: " + title.scene + "\n\n`" + title.command + "`\n\n";
  text += number(run.simulated_seconds) + " s simulated, " + std::to_string(costs.front().runs.size()) +
          " runs of each configuration in turn, " + machine_line(run) +
          ". Median (least–largest). Ratios compare runs of the same round.\n\n";
  text +=
      "| effects | wall [s] | CPU [s] | stage `effects` [s] | all stages [s] | wall per simulated second | "
      "wall / none | CPU / none | peak memory [MiB] | bytes per particle | above none, per particle | memory "
      "/ none | steps / sub-steps "
      "| particles |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const EffectCost& cost : costs) text += markdown_row(cost, costs.front()) + "\n";
  text += "\n";
  for (const EffectCost& cost : costs)
    text += "- `" + cost.name + "`: `effects=" + cost.effects.dump() + "`\n";
  text += failed_lines(costs);
  for (const std::string& note : title.notes) text += "- " + note + "\n";
  return text;
}

}  // namespace oilskin::demo
