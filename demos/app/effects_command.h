/// The command `oilskin effects`.
#pragma once

#include <string>
#include <vector>

namespace oilskin::demo {

struct EffectsOptions {
  std::string scene = "jet";
  std::string out;               ///< empty: out/NAME_effects
  double duration = 0.3;         ///< simulated time of each run [s]
  int threads = 0;               ///< 0 = all hardware threads
  int repeat = 3;                ///< runs of each configuration, ≥ 1
  std::vector<std::string> set;  ///< KEY=VALUE, in all runs
  bool again = false;            ///< repeat runs that are there
  bool quiet = false;
};

/// Runs the scene without effects, with each and with all, in turn, and writes effects.csv, effects.md and
/// effects.svg. The exit code. Throws SceneError for bad input, OutputError when the disk is full.
int effects_command(const EffectsOptions& options);

}  // namespace oilskin::demo
