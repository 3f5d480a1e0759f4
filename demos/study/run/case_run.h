/// One run of a validation case.
#pragma once

#include <functional>

#include "hosts/simulation.h"
#include "output/effect_costs.h"
#include "study/cases/case.h"

namespace oilskin::demo {

/// What a run changes of its case.
struct Variation {
  double step = 1;       ///< length of the step, over the case's
  double thickness = 0;  ///< of all surfaces [spacings]; 0 = the case's
  HostKind host = HostKind::mock;
  PresetKind preset = PresetKind::none;  ///< its step and its settings of fluid and contact
  /// KEY=VALUE: keys of a scene file, but not of cloth, bodies and emitters.
  std::vector<std::string> set;
};
Json to_json(const Variation& variation);
/// Throws SceneError for an unknown word.
HostKind host_of(const std::string& word);
PresetKind preset_of(const std::string& word);

struct CaseCost {
  /// Of the steps, without the certificate's second check (contact.verify) [s]
  std::vector<double> wall_seconds;  ///< one per repetition
  double simulated_seconds = 0;
  std::uint64_t steps = 0, substeps = 0, particles = 0, faces = 0;
  double peak_memory = 0;  ///< of the process [bytes]

  /// Wall time over simulated time: median, least, largest. Zeros where nothing was simulated.
  Spread seconds_per_simulated_second() const;
};

struct CaseRun {
  std::string name;
  double spacing = 0;  ///< [m]
  Variation variation;
  std::vector<Quantity> quantities;
  CaseCost cost;
  std::uint64_t crossings = 0;      ///< found by contact.verify
  double density_error_mean = 0;    ///< over the steps
  double energy_made_fraction = 0;  ///< EnergyReport::made_fraction(), the largest
  std::uint32_t flags = 0;          ///< StepFlag
  std::string failure;              ///< why it did not reach its end; empty = it did
  int signal = 0;                   ///< that stopped it
};

/// The scene of a case as a run has it. Throws SceneError for settings that are refused.
Scene varied_scene(const ValidationCase& of, double spacing, const Variation& variation);

/// Called after every step with the fraction of the run that is done.
using CaseProgress = std::function<void(double fraction)>;

/// Runs to the end, or until a step is refused or a signal comes.
CaseRun run_case(const ValidationCase& of, double spacing, const Variation& variation, int threads,
                 const MakeSimulation& make_simulation, const CaseProgress& progress);

}  // namespace oilskin::demo
