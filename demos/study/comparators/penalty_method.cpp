// Springs and dampers between particles and triangles, on the library's fluid without surfaces.
#include <cmath>
#include <stdexcept>

#include "study/comparators/make_methods.h"
#include "study/comparators/surface_set.h"
#include "study/comparators/world_settings.h"

namespace oilskin::study {
namespace {

/// The forces, as an effect of a world that has no surface attached. It keeps the surfaces in step with the
/// intervals of the world.
class PenaltyForces : public Effect {
 public:
  PenaltyForces(SurfaceSet& surfaces, double reach) : surfaces_(surfaces), reach_(reach) {}

  std::string name() const override { return "penalty"; }
  void begin_step(double time, double dt) { step_end_ = time + dt; }
  void act(EffectForces& forces) override {
    const double rest = (step_end_ - forces.time) / forces.dt;  // intervals that remain, all of one length
    surfaces_.begin_interval(forces.is_last ? 1 : static_cast<int>(std::lround(rest)));
    const std::vector<Near> near = find_near(forces.position, surfaces_, reach_, At::start);
    count_loads(near);
    for (const Near& n : near) press(n, forces);
  }

 private:
  /// Σ of the weights of all contacts at each node: together they must not be stiffer than the node's mass
  /// allows.
  void count_loads(const std::vector<Near>& near) {
    load_.resize(surfaces_.size());
    for (std::size_t s = 0; s < surfaces_.size(); ++s) load_[s].assign(surfaces_[s].x_t1.size(), 0);
    for (const Near& n : near)
      for (std::size_t k = 0; k < 3; ++k) load_[n.surface][n.nodes[k]] += n.weights[k];
  }
  /// The mass that one contact moves [kg], with a bound on what the others at its nodes add.
  double effective_mass(const Near& n, double particle_mass) const {
    double inverse = 1 / particle_mass;
    for (std::size_t k = 0; k < 3; ++k)
      inverse += n.weights[k] * load_[n.surface][n.nodes[k]] * surfaces_[n.surface].inverse_mass[n.nodes[k]];
    return 1 / inverse;
  }
  /// k = m/dt² and c = m/dt: the stiffest spring that symplectic Euler takes without oscillation. Both
  /// eigenvalues of a step are zero.
  void press(const Near& n, EffectForces& forces) {
    const SurfaceMotion& m = surfaces_[n.surface];
    Vec3 velocity = forces.velocity[n.particle] + forces.dt * forces.acceleration[n.particle];
    for (std::size_t k = 0; k < 3; ++k) velocity -= n.weights[k] * m.velocity[n.nodes[k]];
    const double mass = forces.mass(n.particle), effective = effective_mass(n, mass);
    const double approach = -velocity.dot(n.normal);
    const double force = effective / forces.dt * ((reach_ - n.distance) / forces.dt + approach);
    if (force <= 0) return;  // a wall does not pull
    forces.acceleration[n.particle] += force / mass * n.normal;
    surfaces_.push(n.surface, n.nodes, n.weights, -forces.dt * force * n.normal);
  }

  SurfaceSet& surfaces_;
  double reach_, step_end_ = 0;
  std::vector<std::vector<double>> load_;  // per surface and node
};

/// Adds the surfaces to what a world without surfaces shows of its intervals.
class WithSurfaces : public IntervalObserver {
 public:
  explicit WithSurfaces(SurfaceSet& surfaces) : surfaces_(surfaces) {}
  void on_interval(const Interval& interval) override {
    surfaces_.end_interval();
    if (observer == nullptr) return;
    Interval all = interval;
    all.surfaces = surfaces_.motions();
    observer->on_interval(all);
  }
  IntervalObserver* observer = nullptr;

 private:
  SurfaceSet& surfaces_;
};

class PenaltyMethod : public CouplingMethod {
 public:
  explicit PenaltyMethod(const MethodSettings& settings)
      : world_(world_settings(settings), fluid_settings(settings, 1)),
        thickness_(settings.thickness),
        forces_(surfaces_, 0.5 * settings.spacing),
        with_surfaces_(surfaces_) {
    if (!world_.status().ok()) throw std::invalid_argument(world_.status().message);
    const Status added = world_.add_effect(forces_);
    if (!added.ok()) throw std::invalid_argument(added.message);
    world_.set_observer(&with_surfaces_);
  }

  Status attach(SurfaceHost& host, std::size_t* surface) override {
    return surfaces_.attach(host, thickness_, surface);
  }
  Status add_particles(Span<const Vec3> positions, Span<const Vec3> velocities) override {
    return world_.add_particles(positions, velocities);
  }
  Status step(double dt) override {
    Status gathered = surfaces_.gather(dt);
    if (!gathered.ok()) return gathered;
    forces_.begin_step(world_.time(), dt);
    Status stepped = world_.step(dt).status;
    surfaces_.scatter();
    return stepped;
  }

  Span<const std::uint64_t> ids() const override { return world_.ids(); }
  Span<const Vec3> positions() const override { return world_.positions(); }
  Span<const Vec3> velocities() const override { return world_.velocities(); }
  Span<const double> densities() const override { return world_.densities(); }
  Span<const double> pressures() const override { return world_.pressures(); }
  double particle_mass() const override { return world_.particle_mass(); }
  const SurfaceMotion& surface(std::size_t index) const override { return surfaces_[index]; }
  void set_observer(IntervalObserver* observer) override { with_surfaces_.observer = observer; }

 private:
  World world_;
  SurfaceSet surfaces_;
  double thickness_;
  PenaltyForces forces_;
  WithSurfaces with_surfaces_;
};

}  // namespace

std::unique_ptr<CouplingMethod> make_penalty_method(const MethodSettings& settings) {
  return std::make_unique<PenaltyMethod>(settings);
}

}  // namespace oilskin::study
