#include "hosts/bullet_simulation.h"

#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <chrono>

#include "hosts/bullet_body.h"
#include "hosts/mock_simulation.h"
#include "hosts/scene_effects.h"
#include "oilskin/bullet.h"
#include "scene/fields.h"

namespace oilskin::demo {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Keeps the time of the coupling apart from Bullet's own.
class TimedSolver : public bullet::btFluidSoftBodySolver {
 public:
  void updateSoftBodies() override {
    const Clock::time_point start = Clock::now();
    bullet::btFluidSoftBodySolver::updateSoftBodies();
    if (getReport().step == last_step_) return;  // no coupling: nothing but Bullet's normals
    last_step_ = getReport().step;
    seconds_ += seconds_since(start);
  }
  double seconds() const { return seconds_; }

 private:
  std::uint64_t last_step_ = 0;
  double seconds_ = 0;
};

class BulletSimulation : public Simulation {
 public:
  BulletSimulation(const Scene& scene, const SimulationOptions& options)
      : Simulation(scene),
        fluid_(scene.fluid, world_settings(scene, options), scene.contact),
        dispatcher_(&configuration_),
        bullet_(&dispatcher_, &broadphase_, &constraints_, &configuration_, &solver_),
        substeps_(scene.cloth.empty() ? 1 : scene.cloth[0].substeps) {
    require(fluid_.getWorld().status(), "scene");
    // Bullet takes a step that short for none, and would never move.
    const StepPlan plan(scene);
    if (plan.shortest() / substeps_ <= static_cast<double>(SIMD_EPSILON))
      throw SceneError((plan.adaptive() ? "min_dt: a step may take " : "dt: is ") +
                       std::to_string(plan.shortest() * 1e9) + " ns in " + std::to_string(substeps_) +
                       " sub-steps; Bullet makes no sub-step below " +
                       std::to_string(static_cast<double>(SIMD_EPSILON) * 1e9) + " ns in this precision");
    set_up_world();
    require(solver_.addFluid(&fluid_), "fluid");
    solver_.setCouplingInterval(substeps_);
    for (std::size_t i = 0; i < scene.cloth.size(); ++i) add_cloth(i);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) add_body(i);
    for (std::size_t i = 0; i < scene.cloth.size(); ++i) add_anchors(i);
    add_sinks(scene, fluid_.getWorld());
    if (options.emitters) emitters_ = add_emitters(scene, fluid_.getWorld());
    effects_ = add_effects(scene, handles(), fluid_.getWorld());
  }

  ~BulletSimulation() override {
    for (auto& cloth : cloths_) {
      solver_.removeCloth(cloth.get());
      bullet_.removeSoftBody(cloth.get());
    }
    for (BulletBody& body : bodies_) {
      solver_.removeCollisionObject(body.body.get());
      remove_body_from(bullet_, body);
    }
    solver_.removeFluid(&fluid_);
  }

  const StepReport& step(double dt) override {
    const Clock::time_point start = Clock::now();
    const double coupled_before = solver_.seconds();
    const double begin = time_.value(), sub_dt = dt / substeps_;
    move_emitters(begin, dt);
    for (int s = 0; s < substeps_; ++s) {
      const double t = begin + sub_dt * (s + 1);
      for (std::size_t i = 0; i < cloths_.size(); ++i) prescribe(i, t);
      for (std::size_t i = 0; i < cloths_.size(); ++i)
        if (!scene_.cloth[i].wind.isZero(0)) blow_on(i, sub_dt);
      for (std::size_t i = 0; i < bodies_.size(); ++i) prescribe_body(i, t);
      if (grip_) pull(sub_dt, t);
      solver_.setUpdatesNormals(s + 1 == substeps_);
      // 0: exactly one sub-step, whatever is left over in Bullet's clock.
      bullet_.stepSimulation(btScalar(sub_dt), 0);
    }
    time_.add(dt);
    host_seconds_ += seconds_since(start) - (solver_.seconds() - coupled_before);
    return solver_.getReport();
  }

  World& world() override { return fluid_.getWorld(); }
  const World& world() const override { return fluid_.getWorld(); }
  const SurfaceMotion* cloth(std::size_t i) const override { return coupling().getSurface(cloths_[i].get()); }
  const SurfaceMotion* body(std::size_t i) const override {
    return coupling().getSurface(bodies_[i].body.get());
  }
  double host_seconds() const override { return host_seconds_; }
  const char* precision() const override { return sizeof(btScalar) == 4 ? "float32" : "float64"; }

  Status grab_cloth(std::size_t i, const Vec3& point) override {
    std::vector<Vec3> x;
    std::vector<bool> follows;
    for (std::size_t k = 0; k < models_[i].rest.size(); ++k) {
      x.push_back(from_bullet(cloths_[i]->m_nodes[int(k)].m_x));
      const int g = models_[i].pin_group[k];
      follows.push_back(g != not_pinned && models_[i].groups[std::size_t(g)].motion.moves());
    }
    std::optional<Grip> grip = grip_of_cloth(i, models_[i], x, follows, point);
    if (!grip) return Status::refused(grip_refused);
    let_go();
    grip_ = std::move(grip);
    return Status::accepted();
  }

  void grab_body(std::size_t i, const Vec3& point) override {
    let_go();
    btRigidBody& body = *bodies_[i].body;
    if (scene_.bodies[i].is_dynamic()) {  // it is held where it is
      bodies_[i].origin = from_bullet(body.getWorldTransform().getOrigin());
      bodies_[i].turned = body.getWorldTransform().getRotation();
      bodies_[i].displaced.setZero();
      body.setAngularVelocity(btVector3(0, 0, 0));
    }
    // A static body that is moved: Bullet then updates what it keeps of it.
    make_kinematic(bodies_[i]);
    grip_ = grip_of_body(i, point);
  }

  void let_go() override {
    if (!grip_) return;
    if (grip_->is_body)
      leave_body(*grip_);
    else
      free_nodes(*grip_);
    grip_.reset();
  }

  Status set_gravity(const Vec3& gravity) override {
    Status status = world().set_gravity(gravity);
    if (!status.ok()) return status;
    scene_.world.gravity = gravity;
    bullet_.setGravity(to_bullet(gravity));
    bullet_.getWorldInfo().m_gravity = to_bullet(gravity);  // setGravity() does not reach soft bodies
    return status;
  }

 private:
  std::vector<SurfaceId> cloth_ids() const override { return handles(); }
  std::vector<SurfaceId> handles() const {
    std::vector<SurfaceId> ids;
    for (const auto& cloth : cloths_) ids.push_back(coupling().getSurfaceId(cloth.get()));
    return ids;
  }
  const bullet::btFluidCoupling& coupling() const { return solver_.getCoupling(); }

  void set_up_world() {
    const btVector3 gravity = to_bullet(scene_.world.gravity);
    bullet_.setGravity(gravity);
    btSoftBodyWorldInfo& info = bullet_.getWorldInfo();
    info.m_gravity = gravity;  // setGravity() does not reach soft bodies
    info.air_density = 0;
    // Before the first contact. Bullet's cells of 25 cm are made for furniture: in them a ball of 10 cm is a
    // much smaller octahedron. The size is taken over by Reset() only.
    info.m_sparsesdf.setDefaultVoxelsz(btScalar(0.01));
    info.m_sparsesdf.Reset();
  }

  void add_cloth(std::size_t i) {
    const Cloth& settings = scene_.cloth[i];
    const std::string key = "cloth." + std::to_string(i);
    models_.push_back(build_cloth(settings, key));
    const ClothModel& model = models_.back();
    std::vector<btVector3> x;
    std::vector<btScalar> m;
    for (std::size_t k = 0; k < model.rest.size(); ++k) {
      x.push_back(to_bullet(model.rest[k]));
      m.push_back(btScalar(model.pinned_at_start(k) ? 0 : model.mass[k]));
    }
    auto cloth = std::make_unique<btSoftBody>(&bullet_.getWorldInfo(), int(x.size()), x.data(), m.data());
    for (const auto& link : model.links) cloth->appendLink(int(link[0]), int(link[1]));
    for (const Triangle& t : model.triangles) cloth->appendFace(int(t[0]), int(t[1]), int(t[2]));
    cloth->m_materials[0]->m_kLST = 1;
    cloth->m_cfg.kDP = 0;  // it would take momentum out of the world
    cloth->m_cfg.piterations = settings.iterations;
    cloth->m_cfg.viterations = 0;
    cloth->m_cfg.diterations = 0;
    cloth->getCollisionShape()->setMargin(btScalar(cloth_margin));
    bullet_.addSoftBody(cloth.get(), cloth_filter, btBroadphaseProxy::AllFilter);
    require(solver_.addCloth(cloth.get(), settings.surface), key);
    cloths_.push_back(std::move(cloth));
    held_.emplace_back(model.groups.size(), false);
    released_.emplace_back(model.groups.size(), false);
  }

  void add_body(std::size_t i) {
    const Body& settings = scene_.bodies[i];
    const std::string key = "bodies." + std::to_string(i);
    BulletBody made = make_body(settings, key);
    add_body_to(bullet_, made);
    require(settings.is_dynamic() ? solver_.addRigidBody(made.body.get(), settings.surface)
                                  : solver_.addCollisionObject(made.body.get(), settings.surface),
            key);
    bodies_.push_back(std::move(made));
  }

  /// Drag of air on each triangle, ½ ρ_a |u| (u · n) A n with its velocity u relative to the cloth. Bullet's
  /// own leaves cloth that is at rest where it is. Divided by what keeps a node from overshooting the wind.
  void blow_on(std::size_t i, double sub_dt) {
    constexpr double air_density = 1.2;  // [kg/m³]
    btSoftBody& cloth = *cloths_[i];
    for (const Triangle& t : models_[i].triangles) {
      const btSoftBody::Node* n[3];
      for (int k = 0; k < 3; ++k) n[k] = &cloth.m_nodes[int(t[std::size_t(k)])];
      const Vec3 a = from_bullet(n[0]->m_x);
      const Vec3 area = 0.5 * (from_bullet(n[1]->m_x) - a).cross(from_bullet(n[2]->m_x) - a);
      const Vec3 u = scene_.cloth[i].wind - from_bullet((n[0]->m_v + n[1]->m_v + n[2]->m_v) / 3);
      if (area.isZero(0)) continue;
      const double rate = 0.5 * air_density * u.norm() * area.norm() / 3;  // of a node, over its mass [kg/s]
      const Vec3 normal = area.normalized();
      for (int k = 0; k < 3; ++k) {
        if (n[k]->m_im <= 0) continue;
        const double slowed = rate / (1 + rate * sub_dt * static_cast<double>(n[k]->m_im));
        cloth.addForce(to_bullet(Vec3(slowed * u.dot(normal) * normal)), int(t[std::size_t(k)]));
      }
    }
  }

  /// Anchored cloth does not collide with its body.
  void add_anchors(std::size_t i) {
    for (std::size_t a = 0; a < scene_.cloth[i].anchors.size(); ++a) {
      const Anchor& anchor = scene_.cloth[i].anchors[a];
      const std::string key = "cloth." + std::to_string(i) + ".anchors." + std::to_string(a);
      const auto body = static_cast<std::size_t>(anchor.body);
      if (body >= bodies_.size() || !scene_.bodies[body].is_dynamic())
        throw SceneError(key + ".body: is " + std::to_string(anchor.body) +
                         ", must be the index of a body with a mass or density");
      const int before = cloths_[i]->m_anchors.size();
      for (std::size_t k = 0; k < models_[i].rest.size(); ++k)
        if (anchor.within.contains(models_[i].rest[k]))
          cloths_[i]->appendAnchor(int(k), bodies_[body].body.get(), true);
      if (cloths_[i]->m_anchors.size() == before)
        throw SceneError(key + ".within: there is no node of the cloth in it");
    }
  }

  /// Pins the nodes of a group where they are now.
  void hold(std::size_t i, std::size_t g) {
    ClothModel& model = models_[i];
    for (std::size_t k = 0; k < model.rest.size(); ++k) {
      if (model.pin_group[k] != int(g)) continue;
      btSoftBody::Node& node = cloths_[i]->m_nodes[int(k)];
      node.m_im = 0;
      node.m_v = node.m_vn = btVector3(0, 0, 0);
      model.anchor[k] = from_bullet(node.m_x);
    }
    cloths_[i]->updateLinkConstants();
    held_[i][g] = true;
  }

  /// Puts the pins of a cloth where they belong at time t, takes hold of those and lets go of those whose
  /// time has come.
  void prescribe(std::size_t i, double t) {
    const ClothModel& model = models_[i];
    btSoftBody& cloth = *cloths_[i];
    for (std::size_t g = 0; g < model.groups.size(); ++g) {
      const PinBox& group = model.groups[g];
      if (t < group.hold) continue;
      if (group.hold > 0 && !held_[i][g]) hold(i, g);
      const bool releases = t > group.release && !released_[i][g];
      if (released_[i][g] || (!releases && !group.motion.moves())) continue;
      for (std::size_t k = 0; k < model.rest.size(); ++k) {
        if (model.pin_group[k] != int(g)) continue;
        btSoftBody::Node& node = cloth.m_nodes[int(k)];
        if (releases) {
          // Not setMass(): it makes the stretched shape the rest shape.
          node.m_im = btScalar(1 / model.mass[k]);
          node.m_v = node.m_vn = to_bullet(velocity_at(group.motion, model.anchor[k], group.release));
        } else {
          node.m_x = to_bullet(moved(group.motion, model.anchor[k], t));
          node.m_v = btVector3(0, 0, 0);  // Bullet would carry a pinned node on
        }
      }
      if (releases) {
        cloth.updateLinkConstants();
        released_[i][g] = true;
      }
    }
  }

  /// What is held goes with the grip, whatever was prescribed.
  void pull(double sub_dt, double t) {
    grip_->advance(sub_dt);
    if (!grip_->is_body) return hold_nodes(*grip_);
    bodies_[grip_->index].displaced += grip_->velocity * sub_dt;
    place_body(grip_->index, t);
  }

  void hold_nodes(const Grip& grip) {
    btSoftBody& cloth = *cloths_[grip.index];
    bool has_changed = false;
    for (std::size_t n = 0; n < grip.nodes.size(); ++n) {
      btSoftBody::Node& node = cloth.m_nodes[int(grip.nodes[n])];
      has_changed |= node.m_im != 0;
      node.m_im = 0;
      node.m_x = to_bullet(grip.place + grip.offsets[n]);
      node.m_v = node.m_vn = btVector3(0, 0, 0);  // Bullet would carry a pinned node on
    }
    if (has_changed) cloth.updateLinkConstants();
  }

  /// What the water moves goes on with the velocity of the grip.
  void leave_body(const Grip& grip) {
    BulletBody& body = bodies_[grip.index];
    const bool is_dynamic = scene_.bodies[grip.index].is_dynamic();
    if (is_dynamic) body.body->setCollisionFlags(0);
    set_velocity(body, is_dynamic ? grip.velocity : Vec3::Zero());
  }

  /// Pins of the scene stay where they are.
  void free_nodes(const Grip& grip) {
    ClothModel& model = models_[grip.index];
    btSoftBody& cloth = *cloths_[grip.index];
    for (const std::size_t k : grip.nodes) {
      btSoftBody::Node& node = cloth.m_nodes[int(k)];
      if (is_pin(grip.index, k)) {
        model.anchor[k] = from_bullet(node.m_x);
        continue;
      }
      node.m_im = btScalar(1 / model.mass[k]);  // not setMass(): it makes the stretched shape the rest shape
      node.m_v = node.m_vn = to_bullet(grip.velocity);
    }
    cloth.updateLinkConstants();
  }

  bool is_pin(std::size_t i, std::size_t k) const {
    const int g = models_[i].pin_group[k];
    if (g == not_pinned) return false;
    return !released_[i][std::size_t(g)] && (held_[i][std::size_t(g)] || models_[i].pinned_at_start(k));
  }

  void prescribe_body(std::size_t i, double t) {
    if (scene_.bodies[i].motion.moves()) place_body(i, t);
  }

  void place_body(std::size_t i, double t) {
    const bool is_held = grip_ && grip_->is_body && grip_->index == i;
    place(bodies_[i], scene_.bodies[i].motion, t, is_held ? grip_->velocity : Vec3::Zero());
  }

  bullet::btFluid fluid_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraints_;
  TimedSolver solver_;
  btSoftRigidDynamicsWorld bullet_;
  std::vector<std::unique_ptr<btSoftBody>> cloths_;
  std::vector<std::vector<bool>> held_, released_;  ///< per cloth and group of pins
  std::vector<BulletBody> bodies_;
  int substeps_;
  double host_seconds_ = 0;
};

}  // namespace

HostKind built_in_host() {
  return sizeof(btScalar) == 4 ? HostKind::bullet : HostKind::bullet64;
}

std::unique_ptr<Simulation> make_bullet_simulation(const Scene& scene, const SimulationOptions& options) {
  return std::make_unique<BulletSimulation>(scene, options);
}

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options) {
  if (scene.host == HostKind::mock) return make_mock_simulation(scene, options);
  return make_bullet_simulation(scene, options);
}

}  // namespace oilskin::demo
