/// DIR/series.csv: energies, forces on surfaces and other numbers of a run over time
/// (docs/manual/commands_and_formats.md).
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "hosts/simulation.h"

namespace oilskin::demo {

class SeriesOutput {
 public:
  /// A row at every `every`-th step; 0 = no file. Throws OutputError where it cannot be written.
  SeriesOutput(const Scene& scene, const std::string& directory);

  /// Once after every step.
  void after_step(const Simulation& simulation, const World& world, const StepReport& report);
  /// Writes what is left. Throws OutputError.
  void finish();

 private:
  void write_head();
  void write_row(const World& world, const StepReport& report);

  const Scene& scene_;
  std::string path_;
  std::ofstream out_;
  std::vector<SurfaceLoad> loads_;  // since the last row: of cloths, then of bodies
  std::uint64_t steps_ = 0, iterations_ = 0, substeps_ = 0;
  double since_row_ = 0;  // [s]
  std::vector<double> heights_;
};

}  // namespace oilskin::demo
