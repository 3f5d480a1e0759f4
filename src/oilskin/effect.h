/// @file
/// Effects: what acts on the fluid and its surfaces beside pressure, viscosity and contact. A world has those
/// that its user adds, and pays for no others.
#pragma once

#include <functional>
#include <string>

#include "oilskin/contact.h"
#include "oilskin/settings.h"

namespace oilskin {

/// One certified interval, as an effect sees it: a step, or one of its fluid sub-steps. Values per particle
/// are in storage order, which may change from interval to interval. Valid during the call only.
class EffectInterval {
 public:
  virtual ~EffectInterval() = default;
  EffectInterval(const EffectInterval&) = delete;
  EffectInterval& operator=(const EffectInterval&) = delete;

  /// Its length [s].
  double dt = 0;
  /// Simulated time at its start [s].
  double time = 0;
  /// Whether the step begins with it.
  bool is_first = true;
  /// Whether the step ends with it.
  bool is_last = true;
  /// [m/s²]
  Vec3 gravity = Vec3::Zero();
  /// Of a new particle [kg].
  double particle_mass = 0;
  /// Of each particle: its mass over particle_mass, 0 … 1; empty = all are 1.
  Span<const float> mass_ratio;
  /// dx [m].
  double spacing = 0;
  /// H [m].
  double support_radius = 0;
  /// ρ0 [kg/m³].
  double rest_density = 0;
  /// Of the particles.
  Span<const std::uint64_t> id;
  /// [m]: at the start for forces, at the certified end for exchange.
  Span<const Vec3> position;
  /// [m/s], likewise.
  Span<const Vec3> velocity;
  /// [kg/m³], of the last interval.
  Span<const double> density;
  /// The surfaces that collide with the fluid, in order of attachment, between x_t0 and x_t1.
  /// SurfaceMotion::absorbed_mass is the liquid in their nodes.
  Span<SurfaceMotion* const> surfaces;
  /// Their handles.
  Span<const SurfaceId> surface_id;

  /// Mass of particle i [kg].
  double mass(std::size_t i) const {
    return mass_ratio.empty() ? particle_mass : static_cast<double>(mass_ratio[i]) * particle_mass;
  }

  /// The effect's own numbers: one per particle. `channel` counts from 0, below particle_values().size().
  virtual Span<double> of_particles(std::size_t channel) = 0;
  /// One per node of surfaces[surface]; `channel` is below node_values().size().
  virtual Span<double> of_nodes(std::size_t surface, std::size_t channel) = 0;
  /// f(i) for i in 0 … count − 1 on the threads of the world. Results do not depend on their number if f(i)
  /// writes nothing that another f(j) reads or writes.
  virtual void for_each(std::size_t count, const std::function<void(std::size_t)>& f) const = 0;

 protected:
  EffectInterval() = default;
};

/// A triangle that a particle sees within H, or a plane sheet that is represented by its closest triangle.
struct VisibleWall {
  /// Index into EffectInterval::surfaces.
  std::uint32_t surface = 0;
  /// Of the triangle.
  std::array<std::uint32_t, 3> nodes{};
  /// Barycentric, of the closest point, Σ = 1.
  std::array<double, 3> weights{};
  /// Of the triangle's plane, towards the particle; unit.
  Vec3 normal = Vec3::Zero();
  /// From the plane [m], > 0.
  double distance = 0;
  /// The part of the plane's kernel mass (B.7) that is seen through this triangle, 0 … 1: what lies behind
  /// other layers does not count, and the tiles of a sheet add up to 1.
  double share = 0;
  /// Whether the particle is on the back, where SurfaceSettings::slip_back holds.
  bool back = false;
};

/// Before the pressure solve.
class EffectForces : public EffectInterval {
 public:
  /// To be added to [m/s²]. Starts at zero for each interval; one per particle. Those of particles
  /// that an emitter starts in this interval are ignored: they fall freely until the next. A value that is
  /// not finite, or above 1e15, is replaced by zero and reported.
  Span<Vec3> acceleration;

  /// The particles within H of particle i, itself and those behind a surface left out.
  virtual Span<const std::uint32_t> neighbours(std::size_t i) const = 0;
  /// The parts of the surfaces that particle i sees within H. None where no effect of the world
  /// needs_walls().
  virtual Span<const VisibleWall> walls(std::size_t i) const = 0;
  /// A force [N] on a point of surfaces[surface], which acts on its nodes for the interval, like pressure.
  /// `weights`: barycentric, of the three nodes. From one thread at a time. A force that is not finite is
  /// left out, as is one on a surface or node that does not exist.
  virtual void push(std::size_t surface, const std::array<std::uint32_t, 3>& nodes,
                    const std::array<double, 3>& weights, const Vec3& force) = 0;

  /// What the user should know of this interval; empty = nothing. It becomes a message of the step.
  std::string message;
};

/// Liquid that leaves a surface as one particle.
struct Release {
  /// Index into EffectInterval::surfaces.
  std::size_t surface = 0;
  /// Where the particle is to start [m].
  Vec3 position = Vec3::Zero();
  /// A point at the surface from which the way there must be free [m].
  Vec3 from = Vec3::Zero();
  /// What each node gives [kg]; together particle_mass, to 1e-12 of it.
  std::vector<std::pair<std::uint32_t, double>> nodes;
};

/// After the certificate: motion is final, own numbers and masses may change.
class EffectExchange : public EffectInterval {
 public:
  /// Particles near surfaces at the start of the interval. Contact::surface counts in `surfaces`.
  Span<const Contact> contacts;

  // Exchange of liquid, for effects that say changes_masses(). Masses that are not finite or not positive are
  // ignored, as are calls that name a particle, a surface or a node that does not exist. Mass and momentum of
  // water and surfaces together are kept; the hosts weigh their nodes anew at the end of the step. From one
  // thread at a time.

  /// Particle i gives `mass` [kg] to each of three nodes, and keeps its velocity. Together at most what it
  /// has, then it ends. The mass of a particle is a number in single precision: what it gives differs from
  /// `mass` by rounding, and less than 2⁻²⁴ particle_mass does not remain. Returns what it gave.
  virtual double absorb(std::size_t i, std::size_t surface, const std::array<std::uint32_t, 3>& nodes,
                        const std::array<double, 3>& mass) = 0;
  /// At most what `from` has [kg] passes to the node `to`, with the velocity of `from`.
  virtual void transport(std::size_t surface, std::uint32_t from, std::uint32_t to, double mass) = 0;
  /// At most what the node has [kg] leaves as vapour.
  virtual void dry(std::size_t surface, std::uint32_t node, double mass) = 0;
  /// At the end of the step, if the place is free: at least 2 δ from every surface and 0.7 dx from every
  /// particle, inside the kill box, with no triangle in the way. Else nothing happens, and the effect may ask
  /// again. Nor does it if a node has less than it gives, or all together do not give a particle. Until then
  /// the nodes keep their liquid: ask in the last interval of the step.
  virtual void release(const Release& release) = 0;
};

/// An effect. The user creates and owns it; a world keeps a pointer. All calls come from the thread that
/// steps the world, and must not call the world. What act() and exchange() throw ends the step, which leaves
/// no trace in the world; see checkpoint().
class Effect {
 public:
  virtual ~Effect() = default;

  /// In messages and saved worlds.
  virtual std::string name() const = 0;
  /// Accepted, or why it cannot act: World::add_effect() then refuses it with this.
  virtual Status status() const { return {}; }
  /// Per number that the world keeps for each particle: its value in a new particle. Must not change. The
  /// numbers follow their particle, are saved with the world, and end with it.
  virtual std::vector<double> particle_values() const { return {}; }
  /// The same for each node of each surface: the value at a mesh that is new to the world. Teleports keep
  /// them.
  virtual std::vector<double> node_values() const { return {}; }

  /// From how far on act() reads EffectForces::walls() [dx], ≥ 0; H or more: all of them, 0: none. Is asked
  /// in each interval. Without it walls are not searched; up to half of H the boundary terms have found them.
  virtual double wall_reach() const { return 0; }
  /// The longest interval [s] in which act() is stable for such a fluid. Longer steps are cut into fluid
  /// sub-steps, as far as FluidSettings::max_substeps allows; a message says so where it does not. A value
  /// that is not > 0 counts as no limit.
  virtual double longest_interval(const FluidSettings&) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Whether exchange() changes masses. Must not change.
  virtual bool changes_masses() const { return false; }

  /// Whether act() is friction within the liquid and at its surfaces, as FluidSettings::viscosity is. What it
  /// takes is lost then, as by that one; what other effects take is work that they do, and is in
  /// EnergyReport::work_outside. Must not change.
  virtual bool is_friction() const { return false; }

  /// Adds forces, before the pressure solve.
  virtual void act(EffectForces&) {}
  /// Exchanges, after the certificate.
  virtual void exchange(EffectExchange&) {}

  /// Called before each step, for effects with state of their own that act() and exchange() change.
  virtual void checkpoint() {}
  /// Called after a step that an exception ended, thrown by whomever: that state is to be as it was at
  /// checkpoint().
  virtual void roll_back() noexcept {}

  /// World::translate() moves the world by `offset` [m]: places that are the effect's own move with it.
  virtual void translate(const Vec3& /*offset*/) {}

  /// Settings and state beside the numbers above, for saved worlds.
  virtual std::vector<std::uint8_t> save() const { return {}; }
  /// Takes what save() wrote, or refuses and changes nothing.
  virtual Status restore(Span<const std::uint8_t> saved) {
    return saved.empty() ? Status() : Status::refused("there is nothing to restore");
  }
};

}  // namespace oilskin
