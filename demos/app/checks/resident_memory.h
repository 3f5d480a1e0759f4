/// Memory that this process holds in the course of a run.
#pragma once

#include <cstdint>

namespace oilskin::demo {

class ResidentMemory {
 public:
  /// After every step, at time t of a run of `duration` [s].
  void after_step(double t, double duration);
  /// After the last step.
  void finish();

  /// After 20 % of the run [bytes]; 0 where the system does not say or the run ended before.
  std::uint64_t after_a_fifth() const { return after_a_fifth_; }
  std::uint64_t at_end() const { return at_end_; }

 private:
  std::uint64_t after_a_fifth_ = 0, at_end_ = 0;
};

}  // namespace oilskin::demo
