#include "hosts/mock_simulation.h"

#include <chrono>

#include "hosts/mock_cloth.h"
#include "hosts/scene_effects.h"
#include "scene/fields.h"

namespace oilskin::demo {
namespace {

class MockSimulation : public Simulation {
 public:
  MockSimulation(const Scene& scene, const SimulationOptions& options)
      : Simulation(scene), world_(world_settings(scene, options), scene.fluid, scene.contact) {
    require(world_.status(), "scene");
    for (std::size_t i = 0; i < scene.cloth.size(); ++i) {
      const std::string key = "cloth." + std::to_string(i);
      if (!scene.cloth[i].anchors.empty() || !scene.cloth[i].wind.isZero(0))
        throw SceneError(key + ": anchors and wind need the host bullet or bullet64");
      models_.push_back(build_cloth(scene.cloth[i], key));
      cloths_.push_back(std::make_unique<MockCloth>(scene.cloth[i], models_.back()));
      require(world_.attach(*cloths_.back(), scene.cloth[i].surface, &cloth_ids_.emplace_back()), key);
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (scene.bodies[i].is_dynamic())
        throw SceneError("bodies." + std::to_string(i) +
                         ": a body that the water moves needs the host bullet or bullet64");
      bodies_.push_back(std::make_unique<MockBody>(scene.bodies[i], scene.world.kill_box));
      require(world_.attach(*bodies_.back(), scene.bodies[i].surface, &body_ids_.emplace_back()),
              "bodies." + std::to_string(i));
    }
    if (options.emitters) emitters_ = add_emitters(scene, world_);
    add_sinks(scene, world_);
    effects_ = add_effects(scene, cloth_ids_, world_);
  }

  const StepReport& step(double dt) override {
    const auto start = std::chrono::steady_clock::now();
    const double t = time_.value();
    for (std::size_t i = 0; i < cloths_.size(); ++i)
      cloths_[i]->advance(t, dt, scene_.world.gravity, holds_cloth(i) ? &*grip_ : nullptr);
    if (grip_ && grip_->is_body) {
      grip_->advance(dt);
      bodies_[grip_->index]->displace(grip_->velocity, dt);
    }
    for (auto& body : bodies_) body->advance(t + dt);
    move_emitters(t, dt);
    time_.add(dt);
    host_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return world_.step(dt);
  }

  World& world() override { return world_; }
  const World& world() const override { return world_; }
  const SurfaceMotion* cloth(std::size_t i) const override { return world_.surface(cloth_ids_[i]); }
  const SurfaceMotion* body(std::size_t i) const override { return world_.surface(body_ids_[i]); }
  double host_seconds() const override { return host_seconds_; }
  const char* precision() const override { return "float64"; }

  Status grab_cloth(std::size_t i, const Vec3& point) override {
    const MockCloth& cloth = *cloths_[i];
    std::optional<Grip> grip = grip_of_cloth(i, models_[i], cloth.positions(), cloth.follows(), point);
    if (!grip) return Status::refused(grip_refused);
    let_go();
    grip_ = std::move(grip);
    return Status::accepted();
  }
  void grab_body(std::size_t i, const Vec3& point) override {
    let_go();
    grip_ = grip_of_body(i, point);
  }
  void let_go() override {
    if (grip_ && !grip_->is_body) cloths_[grip_->index]->let_go(*grip_);
    grip_.reset();
  }
  Status set_gravity(const Vec3& gravity) override {
    Status status = world_.set_gravity(gravity);
    if (status.ok()) scene_.world.gravity = gravity;
    return status;
  }

 private:
  std::vector<SurfaceId> cloth_ids() const override { return cloth_ids_; }
  bool holds_cloth(std::size_t i) const { return grip_ && !grip_->is_body && grip_->index == i; }

  // Hosts must outlive the world that they are attached to, as effects do.
  std::vector<std::unique_ptr<MockCloth>> cloths_;
  std::vector<std::unique_ptr<MockBody>> bodies_;
  World world_;
  std::vector<SurfaceId> cloth_ids_, body_ids_;
  double host_seconds_ = 0;
};

}  // namespace

std::unique_ptr<Simulation> make_mock_simulation(const Scene& scene, const SimulationOptions& options) {
  return std::make_unique<MockSimulation>(scene, options);
}

}  // namespace oilskin::demo
