/// Steps a method and takes the time of it, without that of the leak counter.
#pragma once

#include <ctime>

#include "study/comparators/coupling_method.h"
#include "study/comparators/leak_counter.h"

namespace oilskin::study {

class RunClock : public IntervalObserver {
 public:
  explicit RunClock(CouplingMethod& method) : method_(method) { method.set_observer(this); }
  ~RunClock() override { method_.set_observer(nullptr); }

  Status step(double dt) {
    simulated_ += dt;
    const double start = now();
    Status status = method_.step(dt);
    seconds_ += now() - start;
    return status;
  }
  void on_interval(const Interval& interval) override {
    const double start = now();
    ++intervals_;
    leaks_.on_interval(interval);
    seconds_ -= now() - start;
  }

  LeakCount leaks() const { return leaks_.count(); }
  std::uint64_t intervals() const { return intervals_; }
  /// Processor time of all threads over simulated time.
  double seconds_per_second() const { return simulated_ > 0 ? seconds_ / simulated_ : 0; }

 private:
  /// Processor time, not wall time: other programs may run beside the study.
  static double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
  CouplingMethod& method_;
  LeakCounter leaks_;
  std::uint64_t intervals_ = 0;
  double seconds_ = 0, simulated_ = 0;
};

}  // namespace oilskin::study
