#include "study/run/case_files.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "output/write_file.h"
#include "run/child_run.h"
#include "run/run_report.h"
#include "scene/scene_reader.h"
#include "study/commit.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

/// JSON has no infinite numbers: null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}
double number(const Json& json) {
  return json.is_null() ? never : json.get<double>();
}

Json to_json(const Quantity& q) {
  return {{"name", q.name},
          {"value", number(q.value)},
          {"reference", number(q.reference)},
          {"scale", number(q.scale)},
          {"uncertainty", number(q.uncertainty)},
          {"tolerance", number(q.tolerance)},
          {"order", q.order}};
}

Quantity quantity_of(const Json& j) {
  return {j.at("name"),          number(j.at("value")),       number(j.at("reference")),
          number(j.at("scale")), number(j.at("uncertainty")), number(j.at("tolerance")),
          j.at("order")};
}

Json to_json(const CaseCost& c) {
  return {{"wall_seconds", c.wall_seconds},
          {"simulated_seconds", c.simulated_seconds},
          {"steps", c.steps},
          {"substeps", c.substeps},
          {"particles", c.particles},
          {"faces", c.faces},
          {"peak_memory", c.peak_memory}};
}

CaseCost cost_of_case(const Json& j) {
  CaseCost c;
  c.wall_seconds = j.at("wall_seconds").get<std::vector<double>>();
  c.simulated_seconds = j.at("simulated_seconds");
  c.steps = j.at("steps");
  c.substeps = j.at("substeps");
  c.particles = j.at("particles");
  c.faces = j.at("faces");
  c.peak_memory = j.at("peak_memory");
  return c;
}

CaseRun run_of(const Json& j, const Variation& variation) {
  CaseRun run;
  run.name = j.at("case");
  run.spacing = j.at("spacing");
  run.variation = variation;
  for (const Json& q : j.at("quantities")) run.quantities.push_back(quantity_of(q));
  run.cost = cost_of_case(j.at("cost"));
  run.crossings = j.at("crossings");
  run.density_error_mean = number(j.at("density_error_mean"));
  run.energy_made_fraction = number(j.at("energy_made_fraction"));
  run.flags = j.at("flags");
  run.failure = j.at("failure");
  return run;
}

/// 64 bits of FNV-1a as text: names of files must not depend on the library's hash.
std::string short_name(const std::string& text) {
  std::uint64_t h = 14695981039346656037u;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211u;
  char name[20];
  std::snprintf(name, sizeof name, "%08llx", static_cast<unsigned long long>(h >> 32));
  return name;
}

}  // namespace

Json machine_of_study(int threads) {
  Json machine = machine_of(threads);
  machine["commit"] = commit;
  return machine;
}

std::string case_file(const std::string& directory, const std::string& name, double spacing,
                      const Variation& variation) {
  char level[40];
  std::snprintf(level, sizeof level, "_%.4gmm", 1e3 * spacing);
  const std::string varied = to_json(variation).dump();
  const bool plain = varied == to_json(Variation()).dump();
  return directory + "/runs/" + name + level + (plain ? "" : "_" + short_name(varied)) + ".json";
}

void write_case_run(const std::string& path, const CaseRun& run, int threads) {
  Json quantities = Json::array();
  for (const Quantity& q : run.quantities) quantities.push_back(to_json(q));
  const Json json = {{"case", run.name},
                     {"spacing", run.spacing},
                     {"variation", to_json(run.variation)},
                     {"machine", machine_of_study(threads)},
                     {"quantities", quantities},
                     {"cost", to_json(run.cost)},
                     {"crossings", run.crossings},
                     {"density_error_mean", number(run.density_error_mean)},
                     {"energy_made_fraction", number(run.energy_made_fraction)},
                     {"flags", run.flags},
                     {"failure", run.failure}};
  write_file(path, json.dump(1) + "\n");
}

std::optional<CaseRun> read_case_run(const std::string& path, const std::string& name, double spacing,
                                     const Variation& variation, int threads) {
  std::error_code error;
  const auto made = fs::last_write_time(path, error);
  if (error || made < fs::last_write_time(program_path())) return {};
  try {
    const Json json = read_json_file(path);
    const bool same = json.at("case") == name && json.at("spacing") == spacing &&
                      json.at("variation") == to_json(variation) &&
                      json.at("machine") == machine_of_study(threads);
    if (same) return run_of(json, variation);
  } catch (const SceneError&) {
    // Damaged: as if it were not there.
  } catch (const Json::exception&) {
  }
  return {};
}

}  // namespace oilskin::demo
