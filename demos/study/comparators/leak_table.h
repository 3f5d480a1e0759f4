/// How many particles of a jet pass a sheet: methods × steps × speeds.
#pragma once

#include "study/comparators/coupling_method.h"
#include "study/comparators/leak_counter.h"
#include "study/comparators/study_hosts.h"

namespace oilskin::study {

/// A piece of a jet, 10 spacings across, strikes a level sheet at right angles.
struct LeakCase {
  Method method = Method::oilskin;
  double dt = 1e-3;                 ///< the step [s], > 0
  double speed = 3;                 ///< of the jet [m/s], ≥ 0
  Held held = Held::border;         ///< of the sheet
  std::optional<int> max_substeps;  ///< as MethodSettings::max_substeps
  double duration = 0.1;            ///< simulated time [s]
  int layers = 25;                  ///< of about 80 particles, a spacing apart
  double areal_density = 0.2;       ///< of the sheet [kg/m²]
};

struct LeakResult {
  LeakCase setup;
  std::size_t particles = 0;  ///< at the start
  std::size_t remaining = 0;  ///< at the end, inside the kill box of ±10 m
  LeakCount leaks;
  double seconds_per_second = 0;  ///< processor time of the method over simulated time
  std::uint64_t intervals = 0;    ///< steps with their sub-steps
  std::string refused;            ///< why the run ended early; empty = it did not
};

/// Throws std::invalid_argument for settings that are out of range.
LeakResult run(const LeakCase& setup);

/// All methods × steps 0.25, 0.5, 1, 2, 4, 8, 16.7 ms × speeds 3, 10, 50, 500 m/s × all nodes held, border
/// held, free.
std::vector<LeakCase> leak_cases();

}  // namespace oilskin::study
