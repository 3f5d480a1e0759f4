#include "hosts/simulation.h"

#include "scene/fields.h"
#include "scene/initial_fields.h"

namespace oilskin::demo {
namespace {

constexpr double turn_time = 0.05;  // [s]

struct AddEmitter {
  World& world;
  std::uint64_t seed;
  EmitterId* id;  // null: no handle

  Status operator()(DiscEmitter e) const {
    e.seed = seed;
    return world.add_emitter(e, id);
  }
  Status operator()(const FilledBox& e) const {
    return world.add_emitter(BoxEmitter{e.box, e.velocity, e.start, initial_state(e.initial, seed)}, id);
  }
  Status operator()(const PlacedMeshEmitter& e) const {
    MeshEmitter emitter;
    emitter.vertices = e.mesh.mesh.vertices;
    emitter.triangles = e.mesh.mesh.triangles;
    emitter.velocity = e.velocity;
    emitter.start = e.start;
    emitter.initial = initial_state(e.initial, seed);
    return world.add_emitter(emitter, id);
  }
  Status operator()(RainEmitter e) const {
    e.seed = seed;
    return world.add_emitter(e, id);
  }
};

}  // namespace

void Simulation::pull_to(const Vec3& goal) {
  if (grip_ && goal.allFinite()) grip_->goal = goal;
}

std::vector<Nozzle> Simulation::nozzles() const {
  std::vector<Nozzle> all;
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    const auto* disc = std::get_if<DiscEmitter>(&scene_.emitters[i].shape);
    if (disc == nullptr) continue;
    const EmitterPose pose = world().emitter(emitters_[i].id)->pose;
    all.push_back({pose.position, pose.rotation * disc->direction.normalized(), disc->radius});
  }
  return all;
}

Status Simulation::aim_nozzle(std::size_t i, const Vec3& direction) {
  std::size_t nozzle = 0;
  for (std::size_t k = 0; k < emitters_.size(); ++k) {
    if (!std::holds_alternative<DiscEmitter>(scene_.emitters[k].shape) || nozzle++ != i) continue;
    if (scene_.emitters[k].motion.moves())
      return Status::refused("nozzle " + std::to_string(i) + " moves as the scene prescribes");
    const EmitterId id = emitters_[k].id;
    return world().move_emitter(id, world().emitter(id)->pose.position, direction, turn_time);
  }
  return Status::refused("there is no nozzle " + std::to_string(i));
}

void Simulation::move_emitters(double t, double dt) {
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    const Motion& motion = scene_.emitters[i].motion;
    if (!motion.moves()) continue;
    const auto& [id, center] = emitters_[i];
    const Vec3 from = moved(motion, center, t), to = moved(motion, center, t + dt);
    require(world().move_emitter(id, {to, Rotation(turned(motion, t + dt))}),
            "emitters." + std::to_string(i));
    if (scene_.emitters[i].inherits_motion)
      require(world().set_inherited_velocity(id, (to - from) / dt), "emitters." + std::to_string(i));
  }
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

std::vector<AddedEmitter> add_emitters(const Scene& scene, World& world) {
  std::vector<AddedEmitter> all;
  for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
    const Emitter& emitter = scene.emitters[i];
    const std::string key = "emitters." + std::to_string(i);
    const bool ages = emitter.max_age < never;
    const bool has_handle =
        std::holds_alternative<DiscEmitter>(emitter.shape) || emitter.motion.moves() || ages;
    AddedEmitter& added = all.emplace_back();
    require(std::visit(AddEmitter{world, scene.seed + i, has_handle ? &added.id : nullptr}, emitter.shape),
            key);
    if (ages) require(world.set_emitter_max_age(added.id, emitter.max_age), key + ".max_age");
    if (has_handle) added.center = world.emitter(added.id)->pose.position;
  }
  return all;
}

void add_sinks(const Scene& scene, World& world) {
  for (std::size_t i = 0; i < scene.sinks.size(); ++i)
    require(world.add_sink(scene.sinks[i]), "sinks." + std::to_string(i));
  require(world.set_max_age(scene.max_age), "max_age");
}

}  // namespace oilskin::demo
