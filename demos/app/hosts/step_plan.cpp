#include "hosts/step_plan.h"

#include <algorithm>
#include <cmath>

namespace oilskin::demo {

void SimulatedTime::add(double dt) {
  if (runs_.empty() || runs_.back().dt != dt) {
    begin_ = value();
    runs_.push_back({dt, 0});
  }
  ++runs_.back().count;
  ++steps_;
}

double SimulatedTime::value() const {
  return runs_.empty() ? 0 : begin_ + runs_.back().dt * static_cast<double>(runs_.back().count);
}

StepPlan::StepPlan(const Scene& scene)
    : adaptive_(scene.adaptive_dt),
      dt_(scene.dt),
      least_(std::min(scene.min_dt, scene.dt)),
      duration_(scene.duration),
      frames_per_second_(scene.pictures.frames_per_second),
      tolerance_(scene.adaptive_dt ? 0.5 * least_ : 1e-9),
      steps_(static_cast<std::uint64_t>(std::ceil(scene.duration / scene.dt - 1e-6))) {}

double StepPlan::next(double t, double suggested) {
  if (!adaptive_) return dt_;
  if (last_ > 0) suggested = std::clamp(suggested, 0.5 * last_, 1.1 * last_);
  last_ = std::clamp(suggested, least_, dt_);
  const double dt = last_, left = next_stop(t) - t;
  if (left <= dt) return left;
  return left < 2 * dt ? 0.5 * left : dt;  // no sliver before the stop
}

/// The next frame or the end of the run. Whether files are written does not matter: the same scene takes the
/// same steps.
double StepPlan::next_stop(double t) const {
  if (frames_per_second_ == 0) return duration_;
  const double frame = std::floor((t + tolerance_) * frames_per_second_) + 1;
  const double stop = frame / frames_per_second_;
  return reached(t, stop) ? duration_ : std::min(stop, duration_);
}

bool StepPlan::done(const SimulatedTime& time) const {
  return adaptive_ ? reached(time.value(), duration_) : time.steps() >= steps_;
}

double StepPlan::fraction(const SimulatedTime& time) const {
  if (!adaptive_) return static_cast<double>(time.steps()) / static_cast<double>(steps_);
  return done(time) ? 1 : time.value() / duration_;
}

}  // namespace oilskin::demo
