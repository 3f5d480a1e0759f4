#include "hosts/simulation.h"

#include "scene/fields.h"
#include "scene/initial_fields.h"

namespace oilskin::demo {
namespace {

constexpr double turn_time = 0.05;  // [s]

struct AddEmitter {
  World& world;
  std::uint64_t seed;
  std::vector<EmitterId>& nozzles;

  Status operator()(DiscEmitter e) const {
    e.seed = seed;
    nozzles.emplace_back();
    return world.add_emitter(e, &nozzles.back());
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

std::vector<Nozzle> Simulation::nozzles() const {
  std::vector<Nozzle> all;
  for (const Emitter& emitter : scene_.emitters) {
    const auto* disc = std::get_if<DiscEmitter>(&emitter);
    if (disc == nullptr || all.size() == nozzles_.size()) continue;
    const EmitterPose pose = world().emitter(nozzles_[all.size()])->pose;
    all.push_back({pose.position, pose.rotation * disc->direction.normalized(), disc->radius});
  }
  return all;
}

Status Simulation::aim_nozzle(std::size_t i, const Vec3& direction) {
  if (i >= nozzles_.size()) return Status::refused("there is no nozzle " + std::to_string(i));
  return world().move_emitter(nozzles_[i], world().emitter(nozzles_[i])->pose.position, direction, turn_time);
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

std::vector<EmitterId> add_emitters(const Scene& scene, World& world) {
  std::vector<EmitterId> nozzles;
  for (std::size_t i = 0; i < scene.emitters.size(); ++i)
    require(std::visit(AddEmitter{world, scene.seed + i, nozzles}, scene.emitters[i]),
            "emitters." + std::to_string(i));
  return nozzles;
}

void add_sinks(const Scene& scene, World& world) {
  for (std::size_t i = 0; i < scene.sinks.size(); ++i)
    require(world.add_sink(scene.sinks[i]), "sinks." + std::to_string(i));
  require(world.set_max_age(scene.max_age), "max_age");
}

}  // namespace oilskin::demo
