#include "hosts/simulation.h"

#include "scene/fields.h"
#include "scene/initial_fields.h"

namespace oilskin::demo {
namespace {

struct AddEmitter {
  World& world;
  std::uint64_t seed;

  Status operator()(DiscEmitter e) const {
    e.seed = seed;
    return world.add_emitter(e);
  }
  Status operator()(const FilledBox& e) const {
    return world.add_emitter(BoxEmitter{e.box, e.velocity, e.start, initial_state(e.initial, seed)});
  }
  Status operator()(const PlacedMeshEmitter& e) const {
    MeshEmitter emitter;
    emitter.vertices = e.mesh.mesh.vertices;
    emitter.triangles = e.mesh.mesh.triangles;
    emitter.velocity = e.velocity;
    emitter.start = e.start;
    emitter.initial = initial_state(e.initial, seed);
    return world.add_emitter(emitter);
  }
  Status operator()(RainEmitter e) const {
    e.seed = seed;
    return world.add_emitter(e);
  }
};

}  // namespace

void Simulation::pull_to(const Vec3& goal) {
  if (grip_ && goal.allFinite()) grip_->goal = goal;
}

void Simulation::set_effects(const SceneEffects& effects) {
  scene_.effects = change_effects(scene_, effects, cloth_ids(), world(), effects_);
}

void require(const Status& status, const std::string& key) {
  if (!status.ok()) throw SceneError(key + ": " + status.message);
}

WorldSettings world_settings(const Scene& scene, const SimulationOptions& options) {
  WorldSettings settings = scene.world;
  settings.threads = options.threads;
  return settings;
}

void add_emitters(const Scene& scene, World& world) {
  for (std::size_t i = 0; i < scene.emitters.size(); ++i)
    require(std::visit(AddEmitter{world, scene.seed + i}, scene.emitters[i]),
            "emitters." + std::to_string(i));
}

void add_sinks(const Scene& scene, World& world) {
  for (std::size_t i = 0; i < scene.sinks.size(); ++i)
    require(world.add_sink(scene.sinks[i]), "sinks." + std::to_string(i));
  require(world.set_max_age(scene.max_age), "max_age");
}

}  // namespace oilskin::demo
