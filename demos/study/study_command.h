/// The command `oilskin study`.
#pragma once

#include <string>
#include <vector>

#include "hosts/simulation.h"

namespace oilskin::demo {

struct StudyOptions {
  std::vector<std::string> parts;  ///< names of sweeps and of tables; empty: all
  std::vector<std::string> cases;  ///< of the sweeps; empty: all that are studied
  std::string out = "out/study";
  int threads = 1;     ///< 0 = all hardware threads
  int repeat = 3;      ///< runs of each, for their times
  bool again = false;  ///< repeat runs that are there
  bool list = false;   ///< only print the parts
  bool quiet = false;
};

/// Varies one parameter at a time and writes tables and plots to DIR. A second call continues and gives the
/// same files. The exit code. Throws SceneError for bad input, OutputError when the disk is full.
int study_command(const StudyOptions& options, HostKind built_in, const MakeSimulation& make_simulation);

}  // namespace oilskin::demo
