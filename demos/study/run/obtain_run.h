/// Runs that are there are read, others are computed.
#pragma once

#include "study/run/case_run.h"

namespace oilskin::demo {

/// How and where runs are made.
struct RunPlace {
  std::string directory;
  int threads = 0;                       ///< 0 = all hardware threads
  int repeat = 1;                        ///< runs of each; the results are the same, the times differ
  bool again = false;                    ///< repeat runs that are there
  HostKind built_in = HostKind::bullet;  ///< the precision of Bullet in this program; the other is a child
  MakeSimulation make_simulation;
};

struct ObtainedRun {
  CaseRun run;
  bool earlier = false;  ///< it was there
};

/// Refuses a folder that cannot be written to. Throws SceneError.
void prepare_place(const RunPlace& place);
/// A run that a signal stopped has `signal` and is not stored. Throws SceneError, OutputError.
ObtainedRun obtain_run(const ValidationCase& of, double spacing, const Variation& variation,
                       const RunPlace& place, const CaseProgress& progress);

}  // namespace oilskin::demo
