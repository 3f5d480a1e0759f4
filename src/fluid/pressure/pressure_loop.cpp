#include "fluid/pressure/pressure_loop.h"

#include <cmath>
#include <iterator>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// Of the number of iterations (F.35): what it falls by in a step, at least by one, and the length of an
/// interval. Water at rest swings with periods of 30 to 80 ms, so that of three whole intervals two need what
/// a swing needs. An impact needs it in one.
constexpr double max_fall = 0.15;
constexpr double interval = 0.05;  // [s]
/// The number that would have left this part of the tolerance was needed.
constexpr double margin = 0.9;

/// Growth of the error from which on a loop diverges. What no pressure removes, as a particle that surfaces
/// enclose, leaves an error that creeps; a smaller ω would not help it, and would slow the rest of the fluid
/// for many steps.
constexpr double least_growth = 1.1;

/// Rise of ω per step (F.24). What made it fall, an impact or a disordered start, passes, and a loop with
/// ω = 1/256 makes no progress.
constexpr double relaxation_rise = 1.02;

}  // namespace

void IterationController::visit(Archive& archive) {
  archive.values(iterations, needed[0], needed[1], needed[2], needed[3], interval_elapsed);
  archive.require(iterations >= 0 && interval_elapsed >= 0, "the number of iterations");
  for (const double n : needed) archive.require(n >= 0, "the number of iterations that was needed");
}

/// The second largest number.
double IterationController::needed_twice() const {
  double largest = 0, second = 0;
  for (const double n : needed) {
    second = std::max(second, std::min(n, largest));
    largest = std::max(largest, n);
  }
  return second;
}

int IterationController::floor() const {
  const double fallen = iterations - std::max(1.0, max_fall * iterations);
  return static_cast<int>(std::ceil(std::min(std::max(needed_twice(), fallen), 1.0 * iterations)));
}

void PressureLoop::visit(Archive& archive) {
  archive.value(relaxation_);
  archive.require(relaxation_ > 0 && relaxation_ <= max_relaxation_, "the relaxation of the pressure");
}

void PressureLoop::begin_step() {
  relaxation_ = std::min(relaxation_rise * relaxation_, max_relaxation_);
}

void PressureLoop::start(const LoopGoal& goal) {
  OILSKIN_ASSERT(goal.min_iterations >= 1 && goal.min_iterations <= max_iterations_);
  goal_ = goal;
  iterations_ = 0;
  converged_ = diverged_ = false;
  last_mean_ = 0;
  growing_ = 0;
}

PressureLoop::Verdict PressureLoop::judge(const Errors& errors) {
  ++iterations_;
  errors_ = errors;
  const double mean = errors.mean(errors.above_target);
  converged_ = mean <= goal_.tolerance;
  Verdict verdict;
  verdict.stop = may_end();
  if (verdict.stop) return verdict;
  verdict.finite = std::isfinite(mean);
  if (!verdict.finite || diverges(mean)) {
    verdict.restart = diverged_ = true;
    relaxation_ = std::max(relaxation_ / 2, min_relaxation);
    last_mean_ = 0;
    growing_ = 0;
  }
  verdict.stop = iterations_ >= std::min(max_iterations_, std::max(limit_, goal_.min_iterations));
  return verdict;
}

/// More iterations make the fluid stiffer against its compression. If their number follows the error, a
/// column that swings is stiffer while it expands than while it is compressed, and gains energy in each
/// period. So the number does not fall below what swings need.
bool PressureLoop::may_end() const {
  return converged_ && iterations_ >= std::max(goal_.min_iterations, goal_.controller.floor());
}

IterationController PressureLoop::next_controller(double dt) const {
  IterationController next = goal_.controller;
  next.iterations = iterations_;
  next.interval_elapsed += dt;
  if (next.interval_elapsed > interval) {
    std::copy_backward(next.needed, std::end(next.needed) - 1, std::end(next.needed));
    next.needed[0] = next.interval_elapsed = 0;
  }
  // In water at rest the error is proportional to the inverse square of the number.
  const double part = errors_.mean(errors_.above_target) / (margin * goal_.tolerance);
  next.needed[0] = std::max(next.needed[0], iterations_ * (part < 1 ? std::sqrt(part) : 1));
  return next;
}

bool PressureLoop::diverges(double mean) {
  const bool far_above = mean > 10 * goal_.tolerance + 1e-3;
  const bool grows = far_above && last_mean_ > 0 && mean > last_mean_;
  if (!grows) growing_ = 0;
  if (grows && growing_++ == 0) before_growth_ = last_mean_;
  last_mean_ = mean;
  return growing_ >= 3 && mean > least_growth * before_growth_;
}

void write(const PressureLoop& loop, FluidReport& report) {
  report.iterations = loop.iterations();
  report.density_error_mean = loop.errors().mean(loop.errors().sum);
  report.density_error_max = loop.errors().largest;
  report.converged = loop.converged();
  report.diverged |= loop.diverged();
}

}  // namespace oilskin::fluid
