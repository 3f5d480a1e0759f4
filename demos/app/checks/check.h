/// The interface of an acceptance check. Each lies in a file of its own, with its settings;
/// checks/check_table.cpp lists them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "checks/resident_memory.h"
#include "checks/totals.h"
#include "hosts/simulation.h"
#include "output/water_mesh.h"
#include "scene/fields.h"

namespace oilskin::demo {

/// One line of a report: a check may give several.
struct CheckResult {
  std::string name;
  double value = 0, limit = 0;
  bool ok = false;
};

CheckResult at_most(const std::string& name, double value, double limit);
CheckResult at_least(const std::string& name, double value, double limit);

/// The state after a step.
struct Moment {
  const Scene& scene;
  Simulation& simulation;
  /// Length of the step [s].
  double dt = 0;
  /// Time after the step [s].
  double t = 0;
  /// True at every tenth step, for checks of quantities that change slowly.
  bool look = false;
  /// Time since the last such step [s].
  double since_look = 0;
};

/// The state after the last step. `simulation` is as that step left it.
struct RunEnd {
  const Scene& scene;
  const Totals& totals;
  const MeshTotals& meshes;
  const ResidentMemory& memory;
  Simulation& simulation;
  const SimulationOptions& options;
  /// Runs the same scene with other options.
  const MakeSimulation& make_simulation;
};

class Check {
 public:
  virtual ~Check() = default;

  /// Reads or writes its keys in the object `acceptance` of a scene.
  virtual void describe(Fields&) {}
  /// Throws SceneError for settings with which the check could not see anything in this scene: it would pass
  /// or fail for the wrong reason.
  virtual void check_scene(const Scene&) const {}
  virtual void after_step(const Moment&) {}
  /// Once, after the last step.
  virtual std::vector<CheckResult> results(const RunEnd& end) = 0;
};

/// A mean over time, for steps that differ in length.
class TimeMean {
 public:
  void add(double value, double dt) {
    sum_ += dt * value;
    time_ += dt;
  }
  bool empty() const { return !(time_ > 0); }
  double sum() const { return sum_; }
  double value() const { return sum_ / time_; }

 private:
  double sum_ = 0, time_ = 0;
};

/// a/b; infinite where b is zero and a is not, 0 where both are.
double ratio(double a, double b);
/// Against gravity, of length 1; +y where there is none.
Vec3 up_of(const Scene& scene);
/// Of all particles at rest [m³].
double water_volume(const Scene& scene, Simulation& simulation);
/// Of the particles [J].
double kinetic_energy(const World& world);
/// Throws SceneError where the scene has no cloth of that index. `key` stands in the message.
void check_cloth_index(const Scene& scene, int index, const std::string& key);
/// Throws SceneError where the scene has no gravity.
void check_has_weight(const Scene& scene);
/// The last `window` seconds of the run.
inline bool in_last(double window, const Moment& now) {
  return now.t > now.scene.duration - window;
}
inline const SurfaceMotion* cloth_of(const Moment& now, int index) {
  return now.simulation.cloth(static_cast<std::size_t>(index));
}

}  // namespace oilskin::demo
