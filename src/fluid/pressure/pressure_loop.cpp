#include "fluid/pressure/pressure_loop.h"

#include <cmath>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// The number of iterations falls by one, or by this ratio, after so many settled steps, in which the smaller
/// number would have left at most this part of the tolerance (F.35).
constexpr double max_fall = 1.18;
constexpr int min_settled_steps = 3;
constexpr double margin = 0.8;

/// Growth of the error from which on a loop diverges. What no pressure removes, as a particle that surfaces
/// enclose, leaves an error that creeps; a smaller ω would not help it, and would slow the rest of the fluid
/// for many steps.
constexpr double least_growth = 1.1;

/// Rise of ω per step (F.24). What made it fall, an impact or a disordered start, passes, and a loop with
/// ω = 1/256 makes no progress.
constexpr double relaxation_rise = 1.02;

}  // namespace

void IterationController::visit(Archive& archive) {
  archive.values(iterations, settled_steps);
  archive.require(iterations >= 0 && settled_steps >= 0, "the number of iterations");
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
  converged_ = diverged_ = fewer_would_do_ = false;
  last_mean_ = 0;
  growing_ = 0;
}

PressureLoop::Verdict PressureLoop::judge(const Errors& errors) {
  ++iterations_;
  errors_ = errors;
  const double mean = errors.mean(errors.above_target);
  converged_ = mean <= goal_.tolerance;
  Verdict verdict;
  verdict.stop = may_end(mean);
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

/// A step with more iterations than necessary leaves the next ones little to do; those then iterate too
/// little, and the pressures oscillate between the two. So the number of iterations falls slowly, and only
/// where fewer would have satisfied the tolerance for some steps: the error is proportional to their inverse
/// square.
bool PressureLoop::may_end(double mean) {
  if (!converged_ || iterations_ < goal_.min_iterations) return false;
  const IterationController& last = goal_.controller;
  if (iterations_ >= last.iterations) return true;
  const double ratio = static_cast<double>(last.iterations) / iterations_;
  if (iterations_ + 1 < last.iterations && ratio > max_fall) return false;
  if (ratio * ratio * mean <= margin * goal_.tolerance) fewer_would_do_ = true;
  return fewer_would_do_ && last.settled_steps >= min_settled_steps;
}

IterationController PressureLoop::next_controller() const {
  const bool fell = iterations_ < goal_.controller.iterations;
  return {iterations_, fewer_would_do_ && !fell ? goal_.controller.settled_steps + 1 : 0};
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
