/// A scene that runs step by step while its settings change.
#pragma once

#include <memory>
#include <string>

#include "hosts/simulation.h"
#include "view/switches.h"

namespace oilskin::demo {

/// Wall time per step, averaged over the last steps [s].
struct StepCosts {
  StageSeconds stages;
  double host = 0;
  double total = 0;  ///< of the whole step
};

/// What was seen since the scene began.
struct SceneCounts {
  std::uint64_t steps = 0, emitted = 0, removed = 0;
  std::uint64_t crossings = 0;  ///< found by contact.verify
  std::uint32_t flags = 0;      ///< StepFlag
};

class LiveScene {
 public:
  /// Throws SceneError for what is refused.
  LiveScene(Scene scene, const SimulationOptions& options, MakeSimulation make_simulation);

  /// Takes one step. Throws SceneError where it is refused.
  void step();
  /// Begins again, with the settings as they are now.
  void restart();
  /// Changes one key of the scene, `key=value` as on the command line; the value null takes it away. `made`:
  /// what the change needed. A refusal changes nothing.
  Status change(const std::string& assignment, Change* made = nullptr);

  /// Simulation::aim_nozzle()
  Status aim_nozzle(std::size_t i, const Vec3& direction);

  const Scene& scene() const { return scene_; }
  /// As write_scene() gives it.
  const Json& settings() const { return settings_; }
  /// The same, as it was loaded.
  const Json& original() const { return original_; }
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  const World& world() const { return simulation_->world(); }
  const StepCosts& costs() const { return costs_; }
  const SceneCounts& counts() const { return counts_; }
  double time() const { return simulation_->time().value(); }
  /// Grows with every step, restart and change: what was drawn for another number is out of date.
  std::uint64_t version() const { return version_; }

 private:
  void apply_live(const Scene& next);
  void add_costs(const StepReport& report, double host, double total);

  SimulationOptions options_;
  MakeSimulation make_simulation_;
  Scene scene_;
  Json settings_, original_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<StepPlan> plan_;
  StepCosts costs_;
  SceneCounts counts_;
  std::uint64_t version_ = 0;
};

}  // namespace oilskin::demo
