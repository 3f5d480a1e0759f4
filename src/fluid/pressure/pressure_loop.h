/// The iteration of an incompressible pressure solver: when it stops, and what happens when it diverges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/archive.h"
#include "oilskin/report.h"

namespace oilskin::fluid {

/// Density errors e_i = ρ*_i/ρ0 − 1 of an iteration. Compression only: a signed mean would let the deficient
/// density at free surfaces hide it, and a mean over spray would dilute it (F.19).
struct Errors {
  double sum = 0, largest = 0;
  double above_target = 0;  // Σ max(0, e_i − target_i)
  std::uint64_t counted = 0;

  void add(double error, double target, double tolerance) {
    if (error <= -tolerance) return;
    sum += std::max(error, 0.0);
    above_target += error < target ? 0 : error - target;  // a NaN is added
    largest = std::max(largest, error);
    ++counted;
  }
  /// `residual` ≥ 0 is what the stop rule judges.
  void add_residual(double error, double residual) {
    if (residual == 0 && error <= 0) return;
    sum += std::max(error, 0.0);
    above_target += residual;
    largest = std::max(largest, error);
    ++counted;
  }
  void operator+=(const Errors& o) {
    sum += o.sum;
    above_target += o.above_target;
    largest = std::max(largest, o.largest);
    counted += o.counted;
  }
  double mean(double total) const { return counted > 0 ? total / static_cast<double>(counted) : 0; }
};

/// Number of iterations of the last step, and how many were needed twice in the last 150 to 200 ms: below
/// that the number does not fall (F.35).
struct IterationController {
  int iterations = 0;  // of the last step; 0 = the loop ends when it has converged
  // The largest number that a step needed, in the present interval of 50 ms and the three before
  double needed[4] = {};
  double interval_elapsed = 0;  // [s]

  double needed_twice() const;
  int floor() const;
  void visit(Archive& archive);
};

/// What a loop has to reach.
struct LoopGoal {
  double tolerance = 0;  // of the mean error above the target
  int min_iterations = 1;
  IterationController controller;
};

/// Stop rule, relaxation ω and divergence rule of a pressure loop. An iteration predicts, finds the errors,
/// corrects the pressures, and then asks judge().
class PressureLoop {
 public:
  static constexpr double min_relaxation = 1.0 / 256;

  /// What to do after a correction.
  struct Verdict {
    bool stop = false;
    bool restart = false;  // the loop diverged; ω has been halved
    bool finite = true;    // if not, the pressures must be reset
  };

  PressureLoop(double max_relaxation, int max_iterations)
      : max_relaxation_(max_relaxation), max_iterations_(max_iterations), relaxation_(max_relaxation) {}

  /// At the start of a step: ω rises again (F.24).
  void begin_step();
  void start(const LoopGoal& goal);
  /// From now on at most so many iterations, at least as many as the goal asks for.
  void limit_iterations(int most) { limit_ = most; }
  /// `errors` are those under the pressures before the correction.
  Verdict judge(const Errors& errors);

  double relaxation() const { return relaxation_; }  ///< ω
  void set_relaxation(double relaxation) noexcept { relaxation_ = relaxation; }
  // Of the loop that ended last
  int iterations() const { return iterations_; }
  const Errors& errors() const { return errors_; }
  bool converged() const { return converged_; }
  bool diverged() const { return diverged_; }  ///< and was restarted
  /// After a step of dt [s].
  IterationController next_controller(double dt) const;

  void visit(Archive& archive);

 private:
  bool may_end() const;
  bool diverges(double mean);

  const double max_relaxation_;  // ω of the calibration
  const int max_iterations_;
  double relaxation_;
  int limit_ = std::numeric_limits<int>::max();

  // Of the loop
  LoopGoal goal_;
  int iterations_ = 0;
  Errors errors_;
  bool converged_ = false, diverged_ = false;
  double last_mean_ = 0;      // of the previous iteration
  int growing_ = 0;           // consecutive iterations with a growing error
  double before_growth_ = 0;  // the error before them
};

void write(const PressureLoop& loop, FluidReport& report);

}  // namespace oilskin::fluid
