/// The command line of `oilskin run`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace oilskin::demo {

struct StepRange {
  std::uint64_t first = 0, last = UINT64_MAX;  ///< both included
};

struct RunOptions {
  std::string scene;
  std::string out;  ///< empty: out/NAME
  std::optional<double> duration, dt;
  std::optional<std::uint64_t> seed;
  int threads = 0;
  std::optional<double> frames_per_second;  ///< absent: as the scene says
  std::optional<bool> render;               ///< absent: if the program can
  bool view = false;
  std::string trace;  ///< empty: none; "-": standard output
  StepRange trace_steps;
  std::vector<std::string> set;
  bool quiet = false;
};

enum class ExitCode : int {
  done = 0,
  check_failed = 1,
  bad_input = 2,
  out_of_resources = 3,
  signalled = 128
};

}  // namespace oilskin::demo
