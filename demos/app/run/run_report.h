/// DIR/report.json (docs/manual/commands_and_formats.md).
#pragma once

#include <string>

#include "checks/acceptance.h"
#include "output/water_mesh.h"
#include "scene/fields.h"

namespace oilskin::demo {

struct RunSummary {
  const Scene& scene;
  const Totals& totals;
  const ResidentMemory& memory;
  const Acceptance& acceptance;
  const std::vector<CheckResult>& checks;
  Simulation& simulation;
  const MeshTotals& meshes;
  int threads = 0;
  double wall_seconds = 0;
  double cpu_seconds = 0;  ///< of all threads, user and system
  double output_seconds = 0;
  int signal = 0;  ///< that stopped the run, or 0
};

/// Processor cores, threads (0 = all cores), compiler and instruction set.
Json machine_of(int threads);
/// Of this process so far.
std::uint64_t peak_memory_bytes();

Json make_report(const RunSummary& summary);

/// Written under a temporary name and renamed. Throws OutputError.
void write_report(const Json& report, const std::string& directory);

}  // namespace oilskin::demo
