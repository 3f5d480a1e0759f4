/// A scene brought to life on one host.
#pragma once

#include <functional>
#include <memory>

#include "hosts/grip.h"
#include "hosts/scene_effects.h"
#include "hosts/step_plan.h"
#include "oilskin/world.h"
#include "scene/cloth_model.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// A round mouth of water.
struct Nozzle {
  Vec3 center = Vec3::Zero();     ///< [m]
  Vec3 direction = Vec3::Zero();  ///< unit
  double radius = 0;              ///< [m]
};

/// An emitter in the world. Only nozzles and emitters that move or limit ages have a handle.
struct AddedEmitter {
  EmitterId id;
  Vec3 center = Vec3::Zero();  ///< at the start [m]
};

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
  virtual const World& world() const = 0;
  /// Positions, velocities and impulses as the last step left them; null while a surface is left out.
  virtual const SurfaceMotion* cloth(std::size_t i) const = 0;
  virtual const SurfaceMotion* body(std::size_t i) const = 0;
  /// Time that the host itself took so far [s].
  virtual double host_seconds() const = 0;
  virtual const char* precision() const = 0;

  /// Takes hold of cloth i where it is nearest to `point`, and lets go of what was held. Refused for nodes
  /// that move as the scene prescribes.
  virtual Status grab_cloth(std::size_t i, const Vec3& point) = 0;
  /// Takes hold of body i, which keeps its orientation while it is held and stays where it is left.
  virtual void grab_body(std::size_t i, const Vec3& point) = 0;
  /// Where the held place is to be; nothing while nothing is held.
  void pull_to(const Vec3& goal);
  /// What is held goes on with the velocity of its place.
  virtual void let_go() = 0;
  const std::optional<Grip>& grip() const { return grip_; }

  /// [m/s²], of the water and of the host. Refuses numbers that are not finite.
  virtual Status set_gravity(const Vec3& gravity) = 0;
  /// The scene's nozzles as they are now, in its order; none of a scene that runs dry.
  std::vector<Nozzle> nozzles() const;
  /// Nozzle i turns to `direction`, of any length > 0, within the next 0.05 s. Refuses what is not finite,
  /// and nozzles that move as the scene prescribes.
  Status aim_nozzle(std::size_t i, const Vec3& direction);
  /// Uses other effects from the next step on. The numbers of effects that stay as they are remain. Throws
  /// SceneError for what is refused.
  void set_effects(const SceneEffects& effects);

  const std::vector<ClothModel>& models() const { return models_; }
  const SimulatedTime& time() const { return time_; }

 protected:
  explicit Simulation(Scene scene) : scene_(std::move(scene)) {}
  /// The handles of the scene's cloth, in its order.
  virtual std::vector<SurfaceId> cloth_ids() const = 0;

  Scene scene_;
  SimulatedTime time_;
  std::vector<ClothModel> models_;
  std::optional<Grip> grip_;
  /// Emitters move to where they are at t + dt, within the next step [s].
  void move_emitters(double t, double dt);

  std::vector<AddedEmitter> emitters_;  ///< in the scene's order; none where it runs dry
  EffectList effects_;
};

/// Makes a simulation of a scene; throws SceneError for what is refused.
using MakeSimulation =
    std::function<std::unique_ptr<Simulation>(const Scene& scene, const SimulationOptions& options)>;

/// Gives the world its emitters.
std::vector<AddedEmitter> add_emitters(const Scene& scene, World& world);
/// Gives it its sinks and its largest age.
void add_sinks(const Scene& scene, World& world);
WorldSettings world_settings(const Scene& scene, const SimulationOptions& options);
/// Throws SceneError with the key in front.
void require(const Status& status, const std::string& key);

}  // namespace oilskin::demo
