/// Lengths of the steps of a run, and its time.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace oilskin::demo {

/// Time as a sum of steps. Equal steps in a row are counted, not added up one by one, so that the time after
/// k steps of dt is k dt.
class SimulatedTime {
 public:
  struct Run {
    double dt = 0;  ///< [s]
    std::uint64_t count = 0;
  };

  void add(double dt);
  double value() const;  ///< [s]
  std::uint64_t steps() const { return steps_; }
  /// The lengths of all steps so far.
  const std::vector<Run>& runs() const { return runs_; }

 private:
  std::vector<Run> runs_;
  double begin_ = 0;  // of the last run
  std::uint64_t steps_ = 0;
};

/// Fixed steps of the scene's dt, as many as reach its duration; or, with `adaptive_dt`, steps as long as the
/// fluid allows, from min_dt to dt, that end exactly at frames and at the end of the run. They grow by a
/// tenth and shrink to a half at most from one to the next: cloth that takes velocities from positions would
/// turn a stretch that a long step left into speed within a short one.
class StepPlan {
 public:
  explicit StepPlan(const Scene& scene);

  bool adaptive() const { return adaptive_; }
  /// No step is shorter [s]: a moment that is nearer than that counts as reached.
  double shortest() const { return adaptive_ ? 0.5 * least_ : dt_; }
  /// The next step [s]; `suggested` by World::suggested_dt(), for adaptive steps.
  double next(double t, double suggested);
  bool reached(double t, double moment) const { return t >= moment - tolerance_; }
  bool done(const SimulatedTime& time) const;
  /// 0 … 1
  double fraction(const SimulatedTime& time) const;

 private:
  double next_stop(double t) const;

  bool adaptive_;
  double dt_, least_, duration_, frames_per_second_, tolerance_;
  std::uint64_t steps_;  // fixed
  double last_ = 0;      // without regard to stops; 0 = there was none
};

}  // namespace oilskin::demo
