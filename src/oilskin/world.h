/// A fluid, the surfaces that it meets, and the step.
#pragma once

#include <memory>

#include "oilskin/contact.h"
#include "oilskin/emitter.h"
#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"
#include "oilskin/trace.h"

namespace oilskin {

/// A typed handle; 0 is none.
struct SurfaceId {
  std::uint64_t value = 0;
  explicit operator bool() const { return value != 0; }
  bool operator==(SurfaceId o) const { return value == o.value; }
};

/// A fluid with the surfaces attached to it.
///
/// *Threads.* One thread at a time may call a world; different worlds are independent. step() runs its loops
/// on WorldSettings::threads threads. It calls hosts and the observer on the caller's thread, as attach()
/// does SurfaceHost::gather().
///
/// *Re-entrancy.* Hosts and the observer must not call the world that calls them.
///
/// *Exceptions.* Wrong input is refused by a Status. What functions throw is std::bad_alloc,
/// std::runtime_error where FCL has no memory, std::length_error beyond 2^32 candidate pairs, and what hosts
/// and the observer throw. The world is then as it was before the call: state_hash(), save(), report() and
/// contacts() give the same, and the next step is the one that would have been. This holds for a step with
/// any number of sub-steps, but not for hosts: those that were read or written keep what that did to them,
/// and one whose gather() returned new_surface must return it again.
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

  const WorldSettings& settings() const;
  const FluidSettings& fluid_settings() const;
  const ContactSettings& contact_settings() const;
  Status set_gravity(const Vec3& gravity);
  Status set_contact_settings(const ContactSettings& settings);

  // --- surfaces. The host stays the caller's and must outlive its attachment.
  /// Refuses a mesh without triangles, indices out of range, non-finite positions, and a thickness below 4 δ
  /// (the message gives the smallest thickness and the largest kill box that would do). Particles nearer than
  /// 2 δ are moved out or removed at the next step, and counted.
  Status attach(SurfaceHost& host, const SurfaceSettings& settings, SurfaceId* id);
  void detach(SurfaceId id);
  std::size_t surface_count() const;
  /// The last step's motion of a surface, with impulses per node; null for an unknown id.
  const SurfaceMotion* surface(SurfaceId id) const;
  /// The next gather of this surface is a teleport, not a motion: it becomes a new surface.
  void reset_motion(SurfaceId id);
  Status set_slip(SurfaceId id, const SlipSettings& slip);  ///< of both sides
  Status set_slip(SurfaceId id, const SlipSettings& front, const SlipSettings& back);

  // --- fluid
  Status add_emitter(const DiscEmitter& emitter);
  Status add_emitter(const BoxEmitter& emitter);
  Status add_emitter(const MeshEmitter& emitter);
  Status add_emitter(const RainEmitter& emitter);
  /// Adds particles by hand; those nearer than 2 δ to a surface are refused one by one and counted in
  /// `blocked`.
  Status add_particles(Span<const Vec3> positions, Span<const Vec3> velocities,
                       std::uint64_t* blocked = nullptr);

  std::size_t particle_count() const;
  /// [kg], ρ0 times the room that a particle takes in water at rest: 0.994 dx³ at H = 2 dx (pcisph, dfsph)
  double particle_mass() const;
  Span<const std::uint64_t> ids() const;  ///< in storage order, which may change every step
  Span<const Vec3> positions() const;     ///< [m]
  Span<const Vec3> velocities() const;    ///< [m/s]
  Span<const double> densities() const;   ///< [kg/m³], of the start of the last step
  Span<const double> pressures() const;   ///< [Pa]
  /// Changes velocities from outside, e.g. a gust: v += dv, one value per particle in storage order.
  Status add_velocities(Span<const Vec3> dv);

  // --- the step
  /// One coupled step of dt [s], 1e-12 … 1e6. On refusal (another dt, bad settings) nothing happens and
  /// report.status says why. Where something would go farther than fluid.cfl spacings, the step is cut into
  /// up to fluid.max_substeps intervals, each with its own certificate; surfaces go straight through them to
  /// where their hosts want them at the end of the step.
  const StepReport& step(double dt);
  /// The longest next step that is accurate, 0 < dt ≤ largest [s]; nothing crosses at longer ones either. The
  /// least of (F.45), (F.46)
  ///   fluid.cfl spacings × max_substeps on the way of whatever is fastest: particles, starts that fall due
  ///   (gravity added), surfaces that touch the fluid's box, as fast as in the last step;
  ///   0.25 √(H/a) × max_substeps, a the largest acceleration by pressure, viscosity and gravity in the last
  ///   interval;
  ///   0.035 H²/ν (F.12) (of the lattice: [Morris1997] has 0.125); and with mcg03 0.4 H/(√k + v).
  double suggested_dt(double largest) const;
  const StepReport& report() const;
  double time() const;  ///< [s]
  std::uint64_t step_count() const;
  /// Contacts of the last step, of its last sub-step where it was cut.
  const std::vector<Contact>& contacts() const;

  /// 64 bits over id, position and velocity bits of every particle in order of id, then node positions and
  /// velocities of every surface in order of attachment. Equal for any number of threads.
  std::uint64_t state_hash() const;

  // --- save and restore, between steps
  /// Writes everything that decides how this world goes on: settings, particles in their order, emitters with
  /// their phases and waiting starts, surfaces as contact left them, what the pressure solver and the
  /// boundary terms remember. Hosts are their owner's to save. `out` is replaced.
  Status save(std::vector<std::uint8_t>* out) const;
  /// Makes this world the saved one: it goes on bit for bit as that one would have, in the same build, if its
  /// hosts are restored, too.
  ///
  /// Before the call the hosts of the saved world must be attached here, in the same order and with the same
  /// meshes (numbers of nodes, triangles, precision of positions); their SurfaceIds stay those of this world.
  /// Where a host's nodes stand at the next step counts as their motion from where the saved world left them.
  /// Settings become the saved ones, but for WorldSettings::threads. report() and contacts() are empty until
  /// the next step; spans that were taken before are invalid.
  ///
  /// Bytes that are damaged, cut off, of another version or byte order, and surfaces that do not match are
  /// refused; the world then stays as it was.
  Status restore(Span<const std::uint8_t> saved);

  void set_observer(IntervalObserver* observer);  ///< not owned; null = none

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin
