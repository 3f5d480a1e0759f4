#include "output/effect_costs.h"

#include <algorithm>

namespace oilskin::demo {
namespace {

std::vector<std::string> failed_checks(const Json& report) {
  std::vector<std::string> failed;
  for (const Json& check : report.at("acceptance"))
    if (!check.at("ok").get<bool>()) failed.push_back(check.at("name").get<std::string>());
  return failed;
}

}  // namespace

RunCost cost_of(const Json& report) {
  RunCost cost;
  cost.wall_seconds = report.at("wall_seconds").get<double>();
  cost.cpu_seconds = report.at("cpu_seconds").get<double>();
  cost.effects_seconds = report.at("seconds").at("effects").get<double>();
  for (const Json& stage : report.at("seconds")) cost.stages_seconds += stage.get<double>();
  cost.simulated_seconds = report.at("simulated_seconds").get<double>();
  cost.peak_memory = report.at("peak_memory_bytes").get<double>();
  cost.steps = report.at("steps").get<std::uint64_t>();
  cost.substeps = report.at("substeps").get<std::uint64_t>();
  cost.particles = report.at("particles").at("alive").get<std::uint64_t>();
  cost.failed = failed_checks(report);
  const Json& machine = report.at("machine");
  cost.precision = machine.at("precision").get<std::string>();
  cost.compiler = machine.at("compiler").get<std::string>();
  cost.instruction_set = machine.at("instruction_set").get<std::string>();
  cost.threads = machine.at("threads").get<int>();
  cost.cores = machine.at("cores").get<int>();
  return cost;
}

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

Spread EffectCost::of(double RunCost::*value) const {
  std::vector<double> values;
  for (const RunCost& run : runs) values.push_back(run.*value);
  return spread_of(values);
}

Spread EffectCost::ratio(double RunCost::*value, const EffectCost& none) const {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < std::min(runs.size(), none.runs.size()); ++k) {
    const double without = none.runs[k].*value;
    ratios.push_back(without > 0 ? runs[k].*value / without : 0);
  }
  return spread_of(ratios);
}

double EffectCost::seconds_per_simulated_second() const {
  return of(&RunCost::wall_seconds).median / of(&RunCost::simulated_seconds).median;
}

double EffectCost::bytes_per_particle() const {
  const auto particles = static_cast<double>(runs.front().particles);
  return particles > 0 ? of(&RunCost::peak_memory).median / particles : 0;
}

double EffectCost::added_bytes_per_particle(const EffectCost& none) const {
  const auto particles = static_cast<double>(runs.front().particles);
  const double added = of(&RunCost::peak_memory).median - none.of(&RunCost::peak_memory).median;
  return particles > 0 ? added / particles : 0;
}

bool EffectCost::checks_hold() const {
  return std::all_of(runs.begin(), runs.end(), [](const RunCost& run) { return run.failed.empty(); });
}

}  // namespace oilskin::demo
