#include "run/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace oilskin::demo {
namespace {

constexpr double bar_interval = 0.1, line_interval = 5;  // [s]
constexpr int bar_width = 30;

}  // namespace

Progress::Progress(bool quiet, bool use_stderr)
    : out_(use_stderr ? stderr : stdout),
      quiet_(quiet),
      terminal_(isatty(fileno(out_)) != 0),
      start_(std::chrono::steady_clock::now()) {}

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::line(const std::string& text) {
  if (quiet_) return;
  finish();
  std::fprintf(out_, "%s\n", text.c_str());
  std::fflush(out_);
}

void Progress::update(double done, double simulated, std::uint64_t particles, const std::string& crossings) {
  if (quiet_) return;
  const double now = seconds();
  const bool last = done >= 1;
  if (!last && now - last_shown_ < (terminal_ ? bar_interval : line_interval)) return;
  last_shown_ = now;
  const double left = done > 0 ? now / done - now : 0;
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "%3.0f %%  t %.3f s  %llu particles  %s  %.0f s left", 100 * done,
                simulated, static_cast<unsigned long long>(particles), crossings.c_str(), left);
  if (!terminal_) {
    std::fprintf(out_, "%s\n", numbers);
  } else {
    const int full = std::clamp(static_cast<int>(done * bar_width), 0, bar_width);
    const std::string bar = std::string(full, '#') + std::string(bar_width - full, '.');
    std::fprintf(out_, "\r[%s] %s\x1b[K", bar.c_str(), numbers);
    bar_open_ = true;
  }
  std::fflush(out_);
}

void Progress::finish() {
  if (bar_open_) std::fprintf(out_, "\n");
  bar_open_ = false;
}

}  // namespace oilskin::demo
