/// Means over time of what a run gives step by step.
#pragma once

namespace oilskin::test {

class Averager {
 public:
  /// A value that holds for dt [s].
  void add(double value, double dt) { add_integral(value * dt, dt); }
  /// The integral of a value over dt [s], such as the impulse of a force.
  void add_integral(double integral, double dt) {
    sum_ += integral;
    time_ += dt;
  }
  double duration() const { return time_; }  // [s]
  double mean() const { return sum_ / time_; }

 private:
  double sum_ = 0, time_ = 0;  // [value s], [s]
};

}  // namespace oilskin::test
