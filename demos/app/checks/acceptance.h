/// The checks by which a scene says whether it did what it should.
#pragma once

#include "checks/check.h"

namespace oilskin::demo {

/// The checks of one run of a scene.
class Acceptance {
 public:
  /// Reads the settings from the scene's `acceptance`. Throws SceneError. The scene must stay where it is.
  explicit Acceptance(const Scene& scene);

  /// The object `acceptance` with every value as resolved.
  Json settings() const;

  /// Once after every step of dt [s].
  void after_step(Simulation& simulation, double dt);
  /// Once after the last step.
  std::vector<CheckResult> results(const RunEnd& end);

 private:
  const Scene& scene_;
  std::vector<std::unique_ptr<Check>> checks_;
  double since_look_ = 0;  // [s]
};

/// The scene with every value as resolved, its acceptance included.
Json resolved_scene(const Scene& scene, const Acceptance& acceptance);

}  // namespace oilskin::demo
