/// What effects cost: measurements of repeated runs, and their comparison with runs without effects.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "oilskin/types.h"
#include "scene/fields.h"

namespace oilskin::demo {

/// One run.
struct RunCost {
  double wall_seconds = 0, cpu_seconds = 0;
  double effects_seconds = 0;    ///< of the stage `effects`
  double stages_seconds = 0;     ///< of all stages
  double simulated_seconds = 0;  ///< > 0
  double peak_memory = 0;        ///< [bytes]
  std::uint64_t steps = 0, substeps = 0;
  std::uint64_t particles = 0;      ///< at the end
  std::vector<std::string> failed;  ///< acceptance checks
  std::string precision, compiler, instruction_set;
  int threads = 0, cores = 0;
};

/// The run whose report this is. Throws Json::exception where a key is missing.
RunCost cost_of(const Json& report);

struct Spread {
  double median = 0, min = 0, max = 0;
};
/// Zeros where there are no values.
Spread spread_of(std::vector<double> values);

/// A configuration of effects with its runs. Run k of all configurations belong to one round.
struct EffectCost {
  std::string name;
  Json effects;  ///< the scene key `effects`
  std::vector<RunCost> runs;

  Spread of(double RunCost::*value) const;
  /// Run by run over those of `none`, so that a slow round counts in both. Where a run of `none` has 0, 0.
  Spread ratio(double RunCost::*value, const EffectCost& none) const;
  /// Wall time over simulated time.
  double seconds_per_simulated_second() const;
  double bytes_per_particle() const;  ///< peak memory over particles; 0 without particles
  /// Peak memory above that of `none`, over particles; 0 without particles.
  double added_bytes_per_particle(const EffectCost& none) const;
  bool checks_hold() const;
};

}  // namespace oilskin::demo
