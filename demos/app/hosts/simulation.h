/// A scene brought to life on one host.
#pragma once

#include <functional>
#include <memory>

#include "hosts/step_plan.h"
#include "oilskin/world.h"
#include "scene/cloth_model.h"
#include "scene/scene.h"

namespace oilskin::demo {

struct SimulationOptions {
  int threads = 0;
  bool emitters = true;  ///< false: the same cloth run dry
};

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// One coupled step of dt [s].
  virtual const StepReport& step(double dt) = 0;
  virtual World& world() = 0;
  /// Positions, velocities and impulses as the last step left them; null while a surface is left out.
  virtual const SurfaceMotion* cloth(std::size_t i) const = 0;
  virtual const SurfaceMotion* body(std::size_t i) const = 0;
  /// Time that the host itself took so far [s].
  virtual double host_seconds() const = 0;
  virtual const char* precision() const = 0;

  const std::vector<ClothModel>& models() const { return models_; }
  const SimulatedTime& time() const { return time_; }

 protected:
  SimulatedTime time_;
  std::vector<ClothModel> models_;
};

/// Makes a simulation of a scene; throws SceneError for what is refused.
using MakeSimulation =
    std::function<std::unique_ptr<Simulation>(const Scene& scene, const SimulationOptions& options)>;

/// Gives the world its emitters.
void add_emitters(const Scene& scene, World& world);
WorldSettings world_settings(const Scene& scene, const SimulationOptions& options);
/// Throws SceneError with the key in front.
void require(const Status& status, const std::string& key);

}  // namespace oilskin::demo
