/// The command `oilskin validate`.
#pragma once

#include <string>
#include <vector>

#include "hosts/simulation.h"

namespace oilskin::demo {

struct ValidateOptions {
  std::vector<std::string> cases;  ///< empty: all
  std::string out = "out/validation";
  int levels = 0;                  ///< only so many of a case's spacings, from the coarsest; 0 = all
  std::vector<double> spacings;    ///< these instead [m]
  double step = 1, thickness = 0;  ///< see Variation
  std::string host = "mock", preset = "none";
  std::vector<std::string> set;
  int threads = 0;     ///< 0 = all hardware threads
  int repeat = 1;      ///< runs of each, for their times
  bool tables = true;  ///< write validation.csv and validation.md
  bool again = false;  ///< repeat runs that are there
  bool list = false;   ///< only print the cases
  bool quiet = false;
};

/// Runs the cases and writes DIR/validation.csv, DIR/validation.md and one file per run. The exit code:
/// check_failed where a tolerance is missed, a run fails, or a crossing is found. Throws SceneError for bad
/// input, OutputError when the disk is full.
int validate_command(const ValidateOptions& options, HostKind built_in,
                     const MakeSimulation& make_simulation);

}  // namespace oilskin::demo
