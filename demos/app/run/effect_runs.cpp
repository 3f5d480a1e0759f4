#include "run/effect_runs.h"

#include <filesystem>
#include <thread>

#include "checks/acceptance.h"
#include "run/child_run.h"
#include "scene/scene_library.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

/// The order of the configurations.
Json default_effects() {
  return {{"wetting", {{"textile", "cotton"}}},
          {"surface_tension", {{"coefficient", 0.0728}, {"contact_angle", 60}}},
          {"viscosity", {{"coefficient", 0.01}}}};
}

/// As report.json would hold it: a file has no infinite numbers.
Json settings_in_file(const RunOptions& options) {
  const Scene scene = load_scene(options);
  const Acceptance acceptance(scene);
  return Json::parse(resolved_scene(scene, acceptance).dump());
}

bool is_of(const RunOptions& options, const Json& report) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return !report.contains("stopped_by_signal") &&
         report.at("machine").at("threads") == (options.threads > 0 ? options.threads : cores) &&
         report.at("settings") == settings_in_file(options);
}

}  // namespace

std::vector<EffectCost> effect_configurations(const RunOptions& options, std::vector<std::string>& named) {
  Json effects = default_effects();
  const Json scene = write_scene(load_scene(options));
  if (scene.contains("effects"))
    for (const auto& [name, settings] : scene["effects"].items()) {
      effects[name] = settings;
      named.push_back(name);
    }
  std::vector<EffectCost> all = {{"none", Json::object(), {}}};
  for (const auto& [name, settings] : effects.items()) all.push_back({name, {{name, settings}}, {}});
  all.push_back({"all", effects, {}});
  return all;
}

RunOptions options_with(const RunOptions& options, const Json& effects, const std::string& out) {
  RunOptions run = options;
  run.out = out;
  run.frames_per_second = 0;
  run.set = {"acceptance={}", "contact.verify=false"};
  run.set.insert(run.set.end(), options.set.begin(), options.set.end());
  run.set.push_back("effects=" + effects.dump());
  return run;
}

void check_scene_of(const RunOptions& options) {
  settings_in_file(options);
}

std::optional<RunCost> cost_of_earlier_run(const RunOptions& options) {
  const fs::path path = fs::path(options.out) / "report.json";
  std::error_code error;
  const auto made = fs::last_write_time(path, error);
  if (error || made < fs::last_write_time(program_path())) return {};
  try {
    const Json report = read_json_file(path.string());
    if (is_of(options, report)) return cost_of(report);
  } catch (const SceneError&) {
    // Damaged: as if it were not there.
  } catch (const Json::exception&) {
  }
  return {};
}

}  // namespace oilskin::demo
