/// @file
/// A fluid, the surfaces that it touches, and the step.
#pragma once

#include <memory>
#include <optional>

#include "oilskin/contact.h"
#include "oilskin/effect.h"
#include "oilskin/emitter.h"
#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/sink.h"
#include "oilskin/surface_motion.h"
#include "oilskin/trace.h"

namespace oilskin {

/// What the fluid gave a surface in the last step, by contact and pressure, prescribed nodes included. Over
/// StepReport::dt it is the mean force [N] and torque [N m].
struct SurfaceLoad {
  /// The sum of the impulses on the nodes [N s].
  Vec3 impulse = Vec3::Zero();
  /// Their moment about the origin [N m s], with the nodes where they got them.
  Vec3 angular_impulse = Vec3::Zero();
};

/// The sum over the nodes of a surface; zero before its first step.
SurfaceLoad load_of(const SurfaceMotion& surface);

/// A fluid with the surfaces attached to it.
///
/// *Threads.* One thread at a time may call a world; different worlds are independent. step() runs its loops
/// on WorldSettings::threads threads, or on those of a JobSystem. It calls hosts and the observer on the
/// caller's thread, as attach() does SurfaceHost::gather().
///
/// *Re-entrancy.* Hosts and the observer must not call the world that calls them.
///
/// *Exceptions.* Wrong input is refused by a Status. What functions throw is std::bad_alloc,
/// std::runtime_error where FCL has no memory, std::length_error beyond 2^32 candidate pairs, and what
/// hosts, the observer and JobSystem::run() throw. The world is then as it was before the call:
/// state_hash(), save(), report() and contacts() give the same, and the next step is the one that would have
/// been. This holds for a step with any number of sub-steps, but not for hosts: those that were read or
/// written keep what that did to them, and one whose gather() returned new_surface must return it again.
class World {
 public:
  /// Settings are validated by the first call that needs them; see status().
  explicit World(const WorldSettings& world = {}, const FluidSettings& fluid = {},
                 const ContactSettings& contact = {});
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Accepted, or what is wrong with the settings given at construction.
  Status status() const;

  /// The settings of the world.
  const WorldSettings& settings() const;
  /// The settings of the fluid.
  const FluidSettings& fluid_settings() const;
  /// The settings of contact.
  const ContactSettings& contact_settings() const;
  /// [m/s²]; refuses numbers that are not finite.
  Status set_gravity(const Vec3& gravity);
  /// Refuses settings that are out of range.
  Status set_contact_settings(const ContactSettings& settings);
  /// WorldSettings::max_particles, from now on; 0 = no limit.
  void set_max_particles(std::uint64_t count);
  /// WorldSettings::step_budget, from now on [s]; refuses numbers out of range.
  Status set_step_budget(double seconds);

  // --- surfaces
  /// The host remains the caller's and must outlive its attachment. Refuses a mesh without triangles, indices
  /// out of range, positions that are not finite, a host that is attached already, and a thickness below 4 δ
  /// (the message has the smallest thickness and the largest kill box that are accepted). The next step
  /// relocates particles closer than 2 δ, or removes them.
  Status attach(SurfaceHost& host, const SurfaceSettings& settings, SurfaceId* id);
  /// Detaches a surface. An unknown id is ignored. Its liquid goes with it, and no report counts that:
  /// absorbed() has it before.
  void detach(SurfaceId id);
  /// The number of attached surfaces.
  std::size_t surface_count() const;
  /// The motion of a surface in the last step, with impulses per node; null for an unknown id.
  const SurfaceMotion* surface(SurfaceId id) const;
  /// The next positions of this surface are a teleport, not a motion: it becomes a new surface.
  void reset_motion(SurfaceId id);
  /// Changes the slip law of both sides.
  Status set_slip(SurfaceId id, const SlipSettings& slip);
  /// Changes the slip law of each side.
  Status set_slip(SurfaceId id, const SlipSettings& front, const SlipSettings& back);

  // --- fluid
  /// Adds a nozzle. `id`: its handle, which is valid until remove_emitter(); null: the emitter is forgotten
  /// when it has ended. `pose`: where it is put; null: where it was given. Refuses what lies outside the kill
  /// box.
  Status add_emitter(const DiscEmitter& emitter, EmitterId* id = nullptr, const EmitterPose* pose = nullptr);
  /// Adds a box to fill.
  Status add_emitter(const BoxEmitter& emitter, EmitterId* id = nullptr, const EmitterPose* pose = nullptr);
  /// Adds a closed mesh to fill.
  Status add_emitter(const MeshEmitter& emitter, EmitterId* id = nullptr, const EmitterPose* pose = nullptr);
  /// Adds rain.
  Status add_emitter(const RainEmitter& emitter, EmitterId* id = nullptr, const EmitterPose* pose = nullptr);

  // Between steps, an emitter can be changed. All calls refuse an unknown handle and numbers that are not
  // finite; an emitter that has ended stays as it is. The phase of a nozzle and of rain, the number of layers
  // or drops so far, is kept, so that the flow is what is asked at each time (F.74).
  /// The emitter moves to the pose within `duration` [s], 0 … 1e6, on a straight line and by the shortest
  /// turn; 0: within the next step. What starts meanwhile starts where the emitter is then. A nozzle that
  /// moves forward along its axis faster than its inherited velocity gives the water the difference, for
  /// layers that are closer than a spacing would burst (F.75).
  Status move_emitter(EmitterId id, const EmitterPose& pose, double duration = 0);
  /// The same for a nozzle: its axis turns from its present direction to `direction`, of any length > 0.
  Status move_emitter(EmitterId id, const Vec3& center, const Vec3& direction, double duration = 0);
  /// The emitter is at the pose from now on. Nothing starts on the way there.
  Status place_emitter(EmitterId id, const EmitterPose& pose);
  /// The same for a nozzle.
  Status place_emitter(EmitterId id, const Vec3& center, const Vec3& direction);
  /// The speed relative to the emitter [m/s], ≥ 0: of a nozzle, whose flow changes with it, of drops, or what
  /// the particles of a volume have in common. Refuses a speed for an emitter that was given no velocity.
  Status set_emitter_speed(EmitterId id, double speed);
  /// The rate of rain [1/s], > 0. Refuses other emitters.
  Status set_drops_per_second(EmitterId id, double rate);
  /// Whether particles start. Starts that wait for a free place are given up where they do not. A volume is
  /// filled when it is enabled and its start time is past.
  Status set_emitter_enabled(EmitterId id, bool enabled);
  /// The velocity of what carries the emitter [m/s], added to that of its particles; 0 at first.
  Status set_inherited_velocity(EmitterId id, const Vec3& velocity);
  /// Removes an emitter; its particles stay. Returns whether there was one.
  bool remove_emitter(EmitterId id);
  /// What an emitter does; none for an unknown handle.
  std::optional<EmitterState> emitter(EmitterId id) const;

  /// Adds particles. Those closer than 2 δ to a surface, outside the kill box or beyond
  /// WorldSettings::max_particles are left out one by one and counted in `blocked`.
  Status add_particles(Span<const Vec3> positions, Span<const Vec3> velocities,
                       std::uint64_t* blocked = nullptr);
  /// Removes the particles in the closed box, between steps; `removed` is their number. The report of the
  /// next step counts them, with mass, momentum and energy, as it does those that leave the kill box. Ids,
  /// order and numbers of the others stay as they are, and spans that were taken before are invalid. Liquid
  /// in surfaces stays there, and emitters go on. Refuses (and removes nothing) a box that is not finite or
  /// has min > max on an axis.
  Status remove_particles(const Box& box, std::uint64_t* removed = nullptr);
  /// The same for the closed ball of `radius` ≥ 0 around `center` [m]. Refuses numbers that are not finite.
  Status remove_particles(const Vec3& center, double radius, std::uint64_t* removed = nullptr);
  /// The same for particles by their ids, in any order; ids that no particle has are ignored. Returns how
  /// many were removed.
  std::uint64_t remove_particles(Span<const std::uint64_t> ids);
  /// The same for all particles.
  void clear();

  // --- sinks
  /// Adds a sink: from the next step on, particles that are in the region at the end of an interval (a step
  /// or a fluid sub-step) end there. The report counts them in StepReport::removed and removed_by_sinks, with
  /// mass, momentum and energy. A particle in several sinks ends in the one that was added first. A particle
  /// that passes through within an interval is not taken: with FluidSettings::cfl and enough fluid sub-steps,
  /// none passes through what is thicker than cfl spacings. `id`: its handle; null: none is kept. Refuses a
  /// region that is out of range.
  Status add_sink(const Region& region, SinkId* id = nullptr);
  /// Gives a sink another region, from the next step on. Refuses an unknown handle, as do the next two.
  Status set_sink_region(SinkId id, const Region& region);
  /// Puts the region of a sink elsewhere: Region::pose.
  Status move_sink(SinkId id, const EmitterPose& pose);
  /// Whether a sink takes particles.
  Status set_sink_enabled(SinkId id, bool enabled);
  /// Removes a sink. Returns whether there was one.
  bool remove_sink(SinkId id);
  /// What a sink does; none for an unknown handle.
  std::optional<SinkState> sink(SinkId id) const;
  /// The age [s], > 0, at which particles end; infinity: none does (default). Present particles live for
  /// `seconds` from now, later ones from their start. The report of the step in which one ends counts it in
  /// StepReport::removed and removed_by_age, with mass, momentum and energy.
  Status set_max_age(double seconds);
  /// [s]; infinity: no limit.
  double max_age() const;
  /// The same for particles that come from an emitter from now on; the smaller of both limits holds. Refuses
  /// an unknown handle.
  Status set_emitter_max_age(EmitterId id, double seconds);

  /// The number of particles.
  std::size_t particle_count() const;
  /// Of a new particle [kg]: ρ0 times its volume in water at rest, 0.994 dx³ at H = 2 dx (pcisph, dfsph).
  double particle_mass() const;
  /// The mass of each particle over particle_mass(), in storage order; empty = all are 1, as without an
  /// effect that changes masses.
  Span<const float> mass_ratios() const;
  /// Of all particles [kg].
  double fluid_mass() const;
  /// In storage order, which may change in every step.
  Span<const std::uint64_t> ids() const;
  /// [m]
  Span<const Vec3> positions() const;
  /// The momentum of each particle over its mass [m/s]. On light cloth it includes momentum that the cloth
  /// has not taken yet, so that water at rest may store several m/s: for what moves, see motions().
  Span<const Vec3> velocities() const;
  /// How fast each particle moves [m/s]: its displacement in the last certified interval over the time of it;
  /// velocities() where it has not moved yet. For pictures, motion blur and speeds.
  Span<const Vec3> motions() const;
  /// [kg/m³], at the start of the last step.
  Span<const double> densities() const;
  /// [Pa]
  Span<const double> pressures() const;
  /// Changes velocities and motions, for example by wind: v += dv, one value per particle in storage order.
  Status add_velocities(Span<const Vec3> dv);

  /// Moves the whole world by `offset` [m], for games far from the origin: particles, surfaces, emitters,
  /// sinks and the kill box, between steps. It is no motion: velocities, loads, phases and contact factors go
  /// on. Call it when what the hosts read has been moved by the same offset. Positions are rounded to what
  /// the hosts store, so distances change by a few units of the last place; particles that rounding brings
  /// closer than 2 δ to a surface are moved away from it in the next step (ContactReport::relocated). δ grows
  /// where larger coordinates need it, and never shrinks. Potential energies are relative to the origin: the
  /// balance counts the change in EnergyReport::entered_potential. Effects move what is
  /// theirs (Effect::translate()); the observer's files are the caller's to move. Refuses an offset that is
  /// not finite, hosts that were not moved, and thicknesses below 4 δ at the new place; a refusal changes
  /// nothing.
  Status translate(const Vec3& offset);

  // --- effects
  /// Adds an effect, which acts from the next step on. It remains the caller's, and must outlive its stay
  /// here. Effects act in the order in which they were added. Refuses one whose settings were refused
  /// (Effect::status()), and a second one of the same name.
  Status add_effect(Effect& effect);
  /// Removes an effect, with its numbers. One that is not there is ignored.
  void remove_effect(const Effect& effect);
  /// The numbers of an effect, one per particle in storage order; empty for an unknown effect or channel.
  Span<const double> particle_values(const Effect& effect, std::size_t channel) const;
  /// The numbers of an effect, one per node; empty for an unknown effect, channel or surface.
  Span<const double> node_values(const Effect& effect, SurfaceId id, std::size_t channel) const;
  /// The liquid that each node of a surface has absorbed [kg]; empty = none.
  Span<const double> absorbed(SurfaceId id) const;
  /// Of all surfaces [kg].
  double absorbed_mass() const;
  /// Sets them between steps. Refuses lists of another length and numbers that are not finite.
  Status set_particle_values(const Effect& effect, std::size_t channel, Span<const double> values);
  /// The same for the nodes of a surface.
  Status set_node_values(const Effect& effect, SurfaceId id, std::size_t channel, Span<const double> values);

  // --- the step
  /// One coupled step of dt [s], 1e-12 … 1e6. A refusal (another dt, settings out of range, thousands of
  /// particles in one place) changes nothing, and report.status says why. If a displacement exceeds fluid.cfl
  /// spacings, or the step is too long for fluid.viscosity or for mcg03's speed of sound, it is cut into up
  /// to fluid.max_substeps intervals, each with its own certificate; surfaces move on straight lines through
  /// them to the positions that their hosts propose for the end of the step.
  const StepReport& step(double dt);
  /// One coupled step of several worlds whose fluids touch the same surfaces: water and oil, or water of two
  /// spacings, at one cloth. Surfaces with the same SurfaceHost are one: it is read and written once, contact
  /// takes the particles of all worlds at once, and each world has its certificate for the motion in which
  /// the surface ends. One after the other, step() would move the surface again after the certificate of the
  /// first.
  ///
  /// Fluids of different worlds do not act on each other but through surfaces: where none is between them,
  /// they pass through each other. Each world keeps its settings, effects, emitters, time and files. Of the
  /// first world are the settings of contact, and the slip of a surface that several worlds have; a shared
  /// surface has the smallest of their thicknesses. All worlds take the largest number of sub-steps that one
  /// of them needs.
  ///
  /// Returns the sum of the reports (StepReport::add_world()). In report() of each world are its particles
  /// and its pressure; what contact did, the impulses on surfaces and the balance of energies are in that of
  /// the first. So momentum_residual() is zero for the sum alone. A surface's loads (load_of()) are those of
  /// all fluids. Refuses what step() refuses, null, a world that is there twice, more than 255 worlds, and
  /// worlds whose FluidSettings::boundary differ. A refusal or an exception changes nothing in any world.
  static StepReport step_together(Span<World* const> worlds, double dt);
  /// The longest accurate next step, 0 < dt ≤ `largest` [s] (F.45); longer steps have no crossing either. It
  /// is the minimum of
  ///   - fluid.cfl spacings × max_substeps over the largest speed: of particles and due starts (gravity
  ///   added), and
  ///     of surfaces that touch the fluid's box, as in the last step;
  ///   - 0.25 √(H/a) × max_substeps, with the largest acceleration a by pressure, viscosity and gravity in
  ///   the last
  ///     interval;
  ///   - 0.035 H²/ν × max_substeps (of the lattice; [Morris1997] has 0.125; less beside XSPH, (F.66)), and
  ///   with
  ///     mcg03 0.4 H/(√k + v) × max_substeps;
  ///   - what the effects state, Effect::longest_interval(), × max_substeps.
  double suggested_dt(double largest) const;
  /// The report of the last step.
  const StepReport& report() const;
  /// Simulated time [s].
  double time() const;
  /// The number of steps.
  std::uint64_t step_count() const;
  /// The contacts of the last step; if it was cut, of its last sub-step. Contact::particle is the index that
  /// the particle had in that step: it is another particle's where the step or the caller has removed
  /// particles since.
  const std::vector<Contact>& contacts() const;
  /// The surfaces that took part in the last step: Contact::surface of contacts() is an index into it. Some
  /// of them may be detached since.
  const std::vector<SurfaceId>& contact_surfaces() const;

  /// 64 bits over the id, position and velocity bits of every particle in the order of ids, then the node
  /// positions and velocities of every surface in the order of attachment. Equal for any number of threads.
  std::uint64_t state_hash() const;

  /// The instruction set of the loops over pairs of particles on this machine: "AVX-512", "AVX2", or that of
  /// the build: "SSE2" or "generic". All give the same bits.
  static const char* instruction_set();

  // --- save and restore, between steps
  /// Writes all that decides how this world continues: settings, particles in their order, emitters with
  /// their phases and waiting starts, surfaces as contact left them, the memory of the pressure solver and of
  /// the boundary terms. Hosts are saved by their owners. `out` is replaced.
  Status save(std::vector<std::uint8_t>* out) const;
  /// Makes this world the saved one. In the same build, and with its hosts restored, it continues bit for bit
  /// as the saved one would have.
  ///
  /// Before the call the hosts of the saved world must be attached here, in the same order and with the same
  /// meshes (numbers of nodes, triangles, storage); their SurfaceIds remain those of this world. The
  /// positions of a host's nodes at the next step are a motion from where the saved world left them. The
  /// effects of the saved world must have been added here, in the same order, and are restored with it. All
  /// settings become the saved ones, except WorldSettings::threads. report() and contacts() are empty until
  /// the next step; spans that were taken before are invalid.
  ///
  /// Bytes that are damaged, cut off, of another version or byte order, and surfaces that do not match are
  /// refused; the world is then unchanged.
  Status restore(Span<const std::uint8_t> saved);

  /// Is called in every interval; not owned; null = none.
  void set_observer(IntervalObserver* observer);

 private:
  struct Impl;
  class JointStep;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin
