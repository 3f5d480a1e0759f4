#include "run/signals.h"

#include <unistd.h>

#include <csignal>

namespace oilskin::demo {
namespace {

volatile std::sig_atomic_t caught = 0;

void on_signal(int number) {
  caught = number;
}

}  // namespace

void watch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // a reader that leaves shows as a failed write
}

int caught_signal() {
  return caught;
}

}  // namespace oilskin::demo
