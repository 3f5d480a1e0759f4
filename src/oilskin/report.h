/// @file
/// What a step reports.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// Wall time per stage of a step [s].
struct StageSeconds {
  /// Reading and writing surfaces.
  double gather = 0;
  /// Sorting and neighbour search.
  double neighbours = 0;
  /// The pressure solver.
  double pressure = 0;
  /// Finding neighbours that surfaces hide.
  double occlusion = 0;
  /// Boundary terms: walls within the support radius.
  double boundary = 0;
  /// Emission, density, viscosity, integration.
  double other_fluid = 0;
  /// Trees and candidates.
  double proximity = 0;
  /// Contacts and Gauss–Seidel iterations.
  double impulses = 0;
  /// The continuous test.
  double ccd = 0;
  /// Impact zones.
  double zones = 0;
  /// Effects.
  double effects = 0;
  /// ContactSettings::verify.
  double verify = 0;

  /// Adds the times stage by stage.
  StageSeconds& operator+=(const StageSeconds& o);
};

/// A bit for each limit that a step reached. The comment of each names the setting that changes it.
enum StepFlag : std::uint32_t {
  /// The pressure solver reached its limit: raise fluid.max_iterations, or lower dt.
  flag_pressure_not_converged = 1u << 0,
  /// A particle passed under contact.infeasible = allow: use stall or remove.
  flag_leaked = 1u << 1,
  /// Prescribed nodes that close on particles were held: slow their motion.
  flag_stalled = 1u << 2,
  /// Particles were removed between prescribed surfaces: slow their motion.
  flag_removed_by_contact = 1u << 3,
  /// Particles that are not finite were removed: lower dt.
  flag_removed_invalid = 1u << 4,
  /// A surface left the kill box, so δ no longer covers rounding: enlarge the box.
  flag_surface_out_of_range = 1u << 5,
  /// A surface was left out; StepReport::messages has the reason.
  flag_surface_refused = 1u << 6,
  /// Nodes were held: use more sub-steps or iterations for the cloth.
  flag_many_holds = 1u << 7,
  /// contact.ccd or contact.zones is off, or particles started closer than δ: crossings are not excluded.
  flag_no_promise = 1u << 8,
  /// A host does not store what it was given: correct its adapter.
  flag_scatter_mismatch = 1u << 9,
  /// The error of the pressure grew and the relaxation ω was halved: water is pressed between surfaces or on
  /// light cloth at a long step, or the support radius is large. Lower dt, or keep support_ratio ≤ 2.2.
  flag_pressure_diverged = 1u << 10,
  /// Energy was made (EnergyReport::risen above energy_made_limit of its scale): StepReport::messages names
  /// the cause and a step or a mass of the cloth that avoids it.
  flag_energy_made = 1u << 13,
  /// The step is too long for fluid.viscosity, even in max_substeps parts, and a smaller viscosity was
  /// applied:
  /// raise max_substeps, or lower dt. StepReport::messages has the numbers.
  flag_viscosity_limited = 1u << 11,
  /// MCG03: sound and water travel farther than 0.4 H in an interval: raise max_substeps, lower dt or
  /// stiffness.
  flag_sound_too_fast = 1u << 12,
  /// The step left out fluid sub-steps, or its pressure solver stopped before it converged, because of
  /// WorldSettings::step_budget: raise it, or use fewer particles.
  flag_budget_limited = 1u << 14,
  /// The pressure of the water asks for shorter intervals than max_substeps gives: with boundary terms it is
  /// compressed by its weight, and boils. Raise max_substeps, or lower dt. StepReport::messages has the
  /// numbers.
  flag_load_limited = 1u << 15,
};

/// EnergyReport::risen over its scale above which flag_energy_made is set. Scenes that are
/// resolved stay below a sixth of it: dam break 0.0032, two bodies of water at a sheet 0.0025, hammock
/// 0.0007.
constexpr double energy_made_limit = 0.02;

/// The names of the bits that are set, each with its remedy.
std::vector<std::string> flag_texts(std::uint32_t flags);

/// Counts and measures of contact in one interval, or their sums over the intervals of a step.
struct ContactReport {
  /// Particle–triangle pairs whose swept boxes overlap.
  std::uint64_t candidates = 0;
  /// Contacts with a constraint.
  std::uint64_t contacts = 0;
  /// Violations found in the iterations of continuous test and impulses.
  std::uint64_t impacts = 0;
  /// Iterations of continuous test and impulses.
  std::uint64_t ccd_iterations = 0;
  /// Iterations of impact zones.
  std::uint64_t zone_rounds = 0;
  /// Members of impact zones at the end.
  std::uint64_t zone_points = 0;
  /// Points held: they end where they started.
  std::uint64_t held = 0;
  /// Separations of particles that ended too close without crossing.
  std::uint64_t separated = 0;
  /// Prescribed nodes held.
  std::uint64_t stalled = 0;
  /// Particles carried along with a triangle.
  std::uint64_t carried_along = 0;
  /// Particles removed because prescribed surfaces close on them.
  std::uint64_t removed = 0;
  /// Particles that passed under Infeasible::allow.
  std::uint64_t allowed = 0;
  /// Contacts that started closer than δ; the certificate does not cover them.
  std::uint64_t started_too_close = 0;
  /// Particles moved away from, or removed at, a new surface.
  std::uint64_t relocated = 0;
  /// The smallest distance at the end over all tested pairs [m].
  double min_distance = std::numeric_limits<double>::infinity();
  /// ContactSettings::verify: particles whose path touches a surface, or that end closer than δ.
  std::uint64_t crossings_found_by_verify = 0;
  /// ContactSettings::verify: pairs that it tested.
  std::uint64_t verified_pairs = 0;
  /// The impulse on free nodes [N s].
  Vec3 impulse_on_free_nodes = Vec3::Zero();
  /// The reaction of pins, static and kinematic nodes, and of particles of infinite mass [N s].
  Vec3 impulse_on_prescribed = Vec3::Zero();
  /// The impulse on dynamic rigid bodies, along axes in which they may move [N s].
  Vec3 impulse_on_bodies = Vec3::Zero();
  /// The momentum of removed particles [N s].
  Vec3 momentum_removed = Vec3::Zero();
  /// The kinetic energy that impulses gave to particles, free nodes and dynamic rigid bodies [J].
  double kinetic_energy_change = 0;

  /// Adds the counts, impulses and energies of another interval; the smaller distance remains.
  void add(const ContactReport& o);
};

/// What the pressure solver reports of one interval.
struct FluidReport {
  /// Iterations of the pressure solver.
  int iterations = 0;
  /// DFSPH: iterations of its divergence solver.
  int divergence_iterations = 0;
  /// The mean of the positive part, relative, over particles whose error exceeds −tolerance.
  double density_error_mean = 0;
  /// The largest relative error.
  double density_error_max = 0;
  /// Whether the error beyond what the step may leave (F.18) came below the tolerance.
  bool converged = true;
  /// Whether the error grew, so that the relaxation was halved.
  bool diverged = false;
  /// Pairs of neighbours that a surface separates.
  std::uint64_t hidden_pairs = 0;
};

/// Two fluid sub-steps together: counts are added, errors are the larger ones, and both flags are kept, so
/// that the last sub-step does not hide a bad one before it.
FluidReport worst_of(const FluidReport& a, const FluidReport& b);

/// Energies, and their balance since the world began (F.56)–(F.62) [J]. Speeds are displacements over time,
/// (x_t1 − x_t0)/dt of the last certified interval, not stored velocities; heights are those of the middle of
/// that interval, so that free fall conserves energy to rounding. Potentials are relative to the origin. Only
/// surfaces that collide with the fluid take part.
struct EnergyReport {
  /// Of the particles.
  double water_kinetic = 0;
  /// Of the particles, by gravity.
  double water_potential = 0;
  /// Of the nodes that are not prescribed.
  double node_kinetic = 0;
  /// Of the nodes that are not prescribed, by gravity.
  double node_potential = 0;
  /// What the impulses of the last step will give to free nodes, at the speeds of the last step. The host
  /// moves them in its next step.
  double transfer = 0;
  /// Brought by particles: from emitters and add_particles().
  double entered_kinetic = 0;
  /// The same, potential; with the nodes of surfaces attached, less those detached.
  double entered_potential = 0;
  /// Of particles that left the fluid within a step, or that the caller removed after the step before. Those
  /// removed before their first step count neither here nor in entered_kinetic.
  double left_kinetic = 0;
  /// The same, potential.
  double left_potential = 0;
  /// Work of pins and of static and kinematic nodes: −reaction impulse × speed.
  double work_prescribed = 0;
  /// Work of hosts on their free nodes, as their links, damping and forces do: the change of momentum that is
  /// neither the fluid's nor gravity's × mean speed. Positive where a host drives its cloth, or gains energy.
  double work_host = 0;
  /// Done to particles by effects but friction, by nozzles and rain that start water below others (F.76), and
  /// between steps: add_velocities(), a change of gravity, particles moved or removed at a new surface.
  double work_outside = 0;
  /// The largest work of gravity so far.
  double released_potential = 0;
  /// Kinetic + potential + transfer + left − entered − work: what the discretization made; negative where
  /// water lost energy by friction and inelastic impacts.
  double made = 0;
  /// `made` of this step.
  double made_in_step = 0;
  /// `made` less its smallest value within the last 0.1 s (up to 0.2 s). Dips of one or two steps do not
  /// count, nor do peaks of one step as far as `transfer` explains them.
  double risen = 0;
  /// What `made` is compared with: the largest of entered_kinetic, released_potential, the largest work of
  /// prescribed nodes and hosts so far, and the energy that lifts the fluid by one spacing.
  double scale = 0;
  /// Root of the mean square speed of the particles [m/s].
  double rms_speed = 0;
  /// Speed of the fastest particle [m/s].
  double max_speed = 0;

  /// made/scale; 0 where nothing has happened.
  double made_fraction() const { return scale > 0 ? made / scale : 0; }
  /// risen/scale.
  double risen_fraction() const { return scale > 0 ? risen / scale : 0; }
};

/// One step. If it was cut into sub-steps, counts and impulses are sums, `fluid` is their worst_of(), and
/// `alive` and the momenta before and after are those of the whole step.
struct StepReport {
  /// Refused: nothing was done.
  Status status;
  /// Surfaces that were left out and why; crossings that ContactSettings::verify found.
  std::vector<std::string> messages;
  /// The number of the step, counted from 0.
  std::uint64_t step = 0;
  /// Simulated time after the step [s].
  double time = 0;
  /// The length of the step [s].
  double dt = 0;
  /// The number of certified intervals.
  int substeps = 0;
  /// The number that viscosity, sound and effects ask for, with flag_load_limited that for the weight of the
  /// water: above `substeps` a flag says which limit is violated. Speeds and pressure may ask for more, up to
  /// FluidSettings::max_substeps.
  double substeps_needed = 1;
  /// WorldSettings::step_budget: the sub-steps that it left out.
  int substeps_left_out = 0;
  /// WorldSettings::step_budget: the most iterations of the pressure solver in a sub-step, where it allowed
  /// fewer than FluidSettings::max_iterations; otherwise 0.
  int iteration_limit = 0;
  /// Wall time by stage.
  StageSeconds seconds;
  /// The pressure solver.
  FluidReport fluid;
  /// Contact.
  ContactReport contact;
  /// Particles after the step.
  std::uint64_t alive = 0;
  /// Particles that emitters added.
  std::uint64_t emitted = 0;
  /// Particles removed by the kill box, by sinks, by age, by contact, at a new surface, or by the caller
  /// since the step before (World::remove_particles(), World::clear()).
  std::uint64_t removed = 0;
  /// Those of them that ended in a sink.
  std::uint64_t removed_by_sinks = 0;
  /// Those of them that ended by age.
  std::uint64_t removed_by_age = 0;
  /// Particles that surfaces absorbed as a whole.
  std::uint64_t absorbed = 0;
  /// Particles that surfaces released.
  std::uint64_t released = 0;
  /// Particles removed because their numbers were not finite.
  std::uint64_t removed_invalid = 0;
  /// Particles that left the kill box more than twice as fast as any energy in the world allows (F.63).
  std::uint64_t removed_too_fast = 0;
  /// Starts without a particle: too close to a surface, or outside the kill box.
  std::uint64_t blocked_starts = 0;
  /// Starts that were lost because there were WorldSettings::max_particles; each is World::particle_mass().
  std::uint64_t limited_starts = 0;
  /// The mass of emitted particles [kg].
  double mass_emitted = 0;
  /// The mass of removed particles [kg].
  double mass_removed = 0;
  /// What surfaces absorbed [kg].
  double mass_absorbed = 0;
  /// What they released as particles [kg].
  double mass_released = 0;
  /// What left them as vapour [kg].
  double mass_dried = 0;
  /// What was lost with nodes of surfaces whose mesh changed [kg].
  double mass_lost = 0;
  /// The momentum of the fluid before the step [N s].
  Vec3 momentum_before = Vec3::Zero();
  /// The momentum of the fluid after the step [N s].
  Vec3 momentum_after = Vec3::Zero();
  /// The momentum of emitted particles [N s].
  Vec3 momentum_emitted = Vec3::Zero();
  /// The momentum of all removed particles [N s].
  Vec3 momentum_removed = Vec3::Zero();
  /// The momentum of the water that surfaces absorbed [N s].
  Vec3 momentum_absorbed = Vec3::Zero();
  /// The momentum of the particles that they released [N s].
  Vec3 momentum_released = Vec3::Zero();
  /// The momentum from gravity [N s].
  Vec3 momentum_gravity = Vec3::Zero();
  /// The momentum that effects gave the fluid and the surfaces [N s]: 0 for forces between them.
  Vec3 momentum_effects = Vec3::Zero();
  /// Energies after the step, and their balance.
  EnergyReport energy;
  /// The share of the impulses on surfaces that went to the hosts' added masses (SurfaceMotion::added_mass)
  /// [N s] (C.31). Neither cloth nor water has it: the supports of the surface take it.
  Vec3 momentum_owed = Vec3::Zero();
  /// The largest ratio of the mass that a node carries in the next step to its own.
  double carried_ratio = 0;
  /// The largest speed p dt/σ [m/s] that the mean load of a node would give to its own mass in a step.
  double load_speed = 0;
  /// StepFlag bits.
  std::uint32_t flags = 0;

  /// After − before − emitted + removed + absorbed − released − gravity − effects + impulses on surfaces [N
  /// s] (C.28): zero up to rounding.
  Vec3 momentum_residual() const;

  /// Makes this the report of several steps: adds that of the step after them. A report without a step
  /// (dt = 0) becomes that step's.
  ///
  /// Sums: dt, substeps, substeps_left_out, seconds, contact, particles and starts counted, masses, and the
  /// momenta that entered, left, came from gravity, effects, or are owed. `fluid`: worst_of(). Largest:
  /// substeps_needed, carried_ratio, load_speed; smallest: iteration_limit, where there is one. `flags` are
  /// or-ed. Of the first step: momentum_before; of the last: step, time, alive, momentum_after, energy, but
  /// for made_in_step (sum) and max_speed (largest). `status` is the first refusal. Messages: add_message().
  void add(const StepReport& next);

  /// Makes this the report of several worlds that were stepped together (World::step_together()): adds that
  /// of another one in the same step. Sums: seconds, contact, particles and starts counted, masses and
  /// momenta. `fluid`: worst_of(). Largest: substeps_needed, substeps_left_out, carried_ratio, load_speed;
  /// smallest: iteration_limit, where there is one. `flags` are or-ed. `status` is the first refusal.
  /// `energy`, step, time, dt and substeps stay as they are: the first world has the balance of all.
  void add_world(const StepReport& other);
};

/// Adds a message to a list, in place of the one about the same surfaces that differs from it in numbers
/// alone, if there is one. A list has at most 256; what comes later is left out.
void add_message(const std::string& message, std::vector<std::string>* list);

}  // namespace oilskin
