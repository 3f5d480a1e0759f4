#include "study/run/obtain_run.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "output/output_error.h"
#include "run/child_run.h"
#include "run/signals.h"
#include "scene/options.h"
#include "study/run/case_files.h"

namespace oilskin::demo {
namespace {

std::vector<std::string> child_arguments(const ValidationCase& of, double spacing, const Variation& v,
                                         const RunPlace& place) {
  const Json words = to_json(v);
  std::vector<std::string> all = {"validate",    of.name,
                                  "--spacing",   exact(spacing),
                                  "--step",      exact(v.step),
                                  "--host",      words.at("host"),
                                  "--preset",    words.at("preset"),
                                  "--threads",   std::to_string(place.threads),
                                  "--repeat",    std::to_string(place.repeat),
                                  "--out",       place.directory,
                                  "--no-tables", "--quiet"};
  if (v.thickness > 0) all.insert(all.end(), {"--thickness", exact(v.thickness)});
  if (place.again) all.push_back("--again");
  for (const std::string& assignment : v.set) all.insert(all.end(), {"--set", assignment});
  return all;
}

CaseRun run_in_child(const ValidationCase& of, double spacing, const Variation& variation,
                     const RunPlace& place, const std::string& file) {
  const int code = run_child(child_arguments(of, spacing, variation, place));
  CaseRun run;
  run.signal = caught_signal();
  if (run.signal != 0) return run;
  const auto found = read_case_run(file, of.name, spacing, variation, place.threads);
  if (!found) throw OutputError(file + ": was not written; the run ended with code " + std::to_string(code));
  return *found;
}

CaseRun run_repeatedly(const ValidationCase& of, double spacing, const Variation& variation,
                       const RunPlace& place, const CaseProgress& progress) {
  CaseRun first;
  for (int k = 0; k < place.repeat; ++k) {
    CaseRun run = run_case(of, spacing, variation, place.threads, place.make_simulation, progress);
    if (run.signal != 0) return run;
    const double seconds = run.cost.wall_seconds.front();
    if (k == 0)
      first = std::move(run);
    else
      first.cost.wall_seconds.push_back(seconds);
  }
  return first;
}

}  // namespace

void prepare_place(const RunPlace& place) {
  std::error_code error;
  std::filesystem::create_directories(place.directory + "/runs", error);
  const std::string probe = place.directory + "/runs/probe.part";
  if (error || !std::ofstream(probe))
    throw SceneError("--out " + place.directory + ": the folder cannot be written to" +
                     (error ? ": " + error.message() : std::string()));
  std::filesystem::remove(probe, error);
}

ObtainedRun obtain_run(const ValidationCase& of, double spacing, const Variation& variation,
                       const RunPlace& place, const CaseProgress& progress) {
  const std::string file = case_file(place.directory, of.name, spacing, variation);
  if (!place.again)
    if (const auto found = read_case_run(file, of.name, spacing, variation, place.threads))
      if (found->cost.wall_seconds.size() >= static_cast<std::size_t>(place.repeat)) return {*found, true};
  if (variation.host != HostKind::mock && variation.host != place.built_in)
    return {run_in_child(of, spacing, variation, place, file), false};
  CaseRun run = run_repeatedly(of, spacing, variation, place, progress);
  if (run.signal == 0) write_case_run(file, run, place.threads);
  return {run, false};
}

}  // namespace oilskin::demo
