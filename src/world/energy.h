/// The balance of energies (F.56)–(F.63).
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "core/archive.h"
#include "core/parallel.h"
#include "fluid/particles.h"
#include "oilskin/report.h"
#include "oilskin/surface_motion.h"

namespace oilskin::world {

/// Kinetic energy [J], and Σ m x [kg m], from which the potential follows for any gravity.
struct Energy {
  double kinetic = 0;
  Vec3 moment = Vec3::Zero();

  /// A mass [kg] that moves with u [m/s] and is at x [m] in the middle of its interval.
  void add(double mass, const Vec3& u, const Vec3& x) {
    kinetic += 0.5 * mass * u.squaredNorm();
    moment += mass * x;
  }
  void operator+=(const Energy& o) {
    kinetic += o.kinetic;
    moment += o.moment;
  }
  double potential(const Vec3& gravity) const { return -gravity.dot(moment); }
  double total(const Vec3& gravity) const { return kinetic + potential(gravity); }
};

/// What the balance keeps from step to step.
struct EnergyState {
  double interval = 0;              ///< length of the last interval [s]; 0 = there was none
  std::uint64_t first_new_id = 1;   ///< particles with this id or a later one have not moved yet
  double max_specific = 0;          ///< kinetic and potential energy of a particle that came in [J/kg]
  double max_node_speed = 0;        ///< of nodes that touched the fluid [m/s]
  Vec3 gravity = Vec3::Zero();      ///< of the last step [m/s²]
  Energy water, nodes;              ///< at the end of the last step
  EnergyReport report;              ///< of the last step
  double gravity_work = 0;          ///< so far [J]
  double max_work = 0;              ///< the largest work so far of prescribed nodes, hosts or callers [J]
  double time = 0, window_end = 0;  ///< since the balance began [s]
  double min_made = 0, min_made_before = 0;  ///< of EnergyReport::made in this window and the one before [J]
  std::array<double, 2> last_made = {0, 0};  ///< of the last two steps, the last first
  Energy withdrawn;                          ///< of particles that the caller removed since the last step

  /// The caller removes particle i, whose mass is `mass` [kg].
  void withdraw(const fluid::Particles& particles, std::size_t i, double mass);
  /// The world is elsewhere by `offset` [m], with the water and the free nodes of these masses [kg].
  void translate(const Vec3& offset, const Vec3& water_mass, const Vec3& node_mass, double withdrawn_mass);
  void visit(Archive& archive);
};

/// The balance of one step. Per interval: begin() in the first, enter(), touch(), then move() and stay() or
/// leave(), or lose(), for each particle, end_interval(). After the last one end_surface() and finish().
class EnergyBalance {
 public:
  /// Of some of the particles in an interval: threads add up their own.
  struct Sums {
    Energy water, left;
    double by_effects = 0;       // [J]
    double most_by_effects = 0;  // on any particle [J/kg]
    double max_speed = 0;        // squared

    void operator+=(const Sums& o) {
      water += o.water;
      left += o.left;
      by_effects += o.by_effects;
      most_by_effects = std::max(most_by_effects, o.most_by_effects);
      max_speed = std::max(max_speed, o.max_speed);
    }
  };

  /// A new particle weighs `particle_mass` [kg].
  EnergyBalance(EnergyState& state, double particle_mass, const Vec3& gravity)
      : state_(state), mass_(particle_mass), gravity_(gravity), water_before_(state.water) {}

  /// The particles at the start of the first interval, of length dt [s].
  void begin(const fluid::Particles& particles, double dt, const Workers& workers);
  /// An emitter starts a particle in an interval of length dt.
  void enter(const Vec3& x, const Vec3& velocity, double dt);
  /// Impulses and motion of the surfaces in an interval of length dt. `before`: each as the interval or step
  /// before, of length dt_before, left it; null = it moved with the same speed.
  void touch(Span<SurfaceMotion* const> surfaces, double dt, Span<const SurfaceMotion* const> before,
             double dt_before);

  /// Particle i went from `start` to particles.position within `time` [s]: sets particles.motion.
  static void move(fluid::Particles& particles, std::size_t i, const Vec3& start, double time, double dt);
  /// Effects accelerated a particle for dt. `motion`: mean of its speeds in the last interval and in this
  /// one, with which free motion conserves energy to rounding, as (F.57) does in gravity.
  void drive(double mass_ratio, const Vec3& acceleration, const Vec3& motion, double dt, Sums& sums) const {
    const double work = dt * acceleration.dot(motion);  // [J/kg]
    sums.by_effects += mass_ratio * mass_ * work;
    sums.most_by_effects = std::max(sums.most_by_effects, work);
  }
  /// Work of effects on a surface, or of emitters against pressure (F.76) [J].
  void drive(double work) { by_effects_ += work; }

  void stay(const fluid::Particles& particles, std::size_t i, double dt, Sums& sums) const;
  void leave(const fluid::Particles& particles, std::size_t i, double dt, Sums& sums) const;
  /// A surface absorbs the part `mass_ratio` of a new particle's mass from particle i.
  void absorb(const fluid::Particles& particles, std::size_t i, double mass_ratio, double dt,
              Sums& sums) const;
  /// Particle i is removed at `start`: it has no certified end.
  void lose(const fluid::Particles& particles, std::size_t i, const Vec3& start, double dt, Sums& sums) const;
  /// Whether particle i is faster than any energy in the world allows (F.63).
  bool is_too_fast(const fluid::Particles& particles, std::size_t i) const;
  /// `sums` are of all particles; `next_id` is that of particles to come.
  void end_interval(const Sums& sums, std::uint64_t next_id, double dt);

  /// The water of `other` counts with this one's: its surfaces are the same. `other` is finished later, and
  /// has the numbers of its water alone.
  void include(EnergyBalance& other);
  /// What makes a particle too fast, of both.
  void share_limits(EnergyBalance& other);
  /// A surface at the end of a step of dt, and as the step of dt_before left it.
  void end_surface(const SurfaceMotion& now, double dt, const SurfaceMotion& before, double dt_before,
                   const Workers& workers);
  /// The report of a step of dt. `spacing` [m] is the resolution of heights. The mass of the particles is
  /// `relative_mass` [particle_mass]; of others with this one's, that and their own [kg].
  const EnergyReport& finish(double relative_mass, double mass_of_others, double dt, double spacing);

 private:
  /// Impulse [N s], and moment about the centre of mass [N m s].
  struct BodyLoad {
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero();
  };

  double mass_of(const fluid::Particles& particles, std::size_t i) const {
    return particles.relative_mass(i) * mass_;
  }
  Vec3 middle(const fluid::Particles& particles, std::size_t i, const Vec3& x, double dt) const;
  const EnergyReport& finish_water(double mass);
  double transfer_to_body(const BodyMotion& body, double dt, BodyLoad& so_far) const;
  void update_scale(double least);
  void update_window(double dt);

  EnergyState& state_;
  const double mass_;  // of a new particle [kg]
  const Vec3 gravity_;

  // Of the step
  const Energy water_before_;
  double lowest_ = std::numeric_limits<double>::infinity();  // potential of a particle [J/kg]
  Energy start_, entered_, left_, nodes_before_, nodes_;
  // Work of the fluid [J]: on prescribed nodes; on free ones at the speeds of the step; what the latter was
  // off by in the step before.
  double on_prescribed_ = 0, transfer_ = 0, late_ = 0;
  std::vector<BodyLoad> body_loads_;  // so far in the step, of each surface of touch()
  double by_effects_ = 0;             // work of effects on particles and surfaces [J]
  std::vector<const EnergyBalance*> others_;
  bool is_included_ = false;  // in that of another world
};

}  // namespace oilskin::world
