/// How far a run is: a bar on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace oilskin::demo {

class Progress {
 public:
  /// Nothing at all when quiet. Standard error serves when standard output carries a trace.
  Progress(bool quiet, bool use_stderr);

  void line(const std::string& text);
  /// `crossings`: crossings_text().
  void update(double done, double simulated, std::uint64_t particles, const std::string& crossings);
  /// Ends the bar's line.
  void finish();

 private:
  double seconds() const;

  std::FILE* out_;
  bool quiet_, terminal_, bar_open_ = false;
  std::chrono::steady_clock::time_point start_;
  double last_shown_ = -1e9;
};

}  // namespace oilskin::demo
