/// What a step tells about itself.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// Wall time per stage of a step [s].
struct StageSeconds {
  double gather = 0;      ///< reading and writing surfaces
  double neighbours = 0;  ///< sorting and neighbour search
  double pressure = 0;
  double occlusion = 0;    ///< neighbours hidden by surfaces
  double boundary = 0;     ///< boundary terms: walls within the support radius
  double other_fluid = 0;  ///< emission, density, viscosity, integration
  double proximity = 0;    ///< trees, candidates
  double impulses = 0;     ///< records and Gauss–Seidel
  double ccd = 0;          ///< detection
  double zones = 0;
  double effects = 0;
  double verify = 0;  ///< the independent check, when asked for

  StageSeconds& operator+=(const StageSeconds& o);
};

/// A bit per thing that was given up; each comment names the setting that mends it.
enum StepFlag : std::uint32_t {
  flag_pressure_not_converged = 1u << 0,  ///< raise fluid.max_iterations, or lower dt
  flag_leaked = 1u << 1,   ///< contact.infeasible = allow, and a particle passed; use stall or remove
  flag_stalled = 1u << 2,  ///< prescribed nodes were held: they close on particles; slow their motion
  flag_removed_by_contact = 1u << 3,  ///< particles were given up between prescribed surfaces
  flag_removed_invalid = 1u << 4,     ///< non-finite particles were removed; lower dt
  flag_surface_out_of_range =
      1u << 5,  ///< a surface left the kill box, so δ no longer covers rounding: enlarge it
  flag_surface_refused = 1u << 6,  ///< a surface was left out; its message is in StepReport::messages
  flag_many_holds = 1u << 7,       ///< held nodes: use more cloth sub-steps or iterations
  flag_no_promise = 1u << 8,       ///< contact.ccd or contact.zones is off, or particles began closer than δ
  flag_scatter_mismatch = 1u << 9,    ///< a host does not store what it was given; its adapter is at fault
  flag_pressure_diverged = 1u << 10,  ///< ω was halved; keep support_ratio ≤ 2.2
};

/// The names of the bits that are set, each with what mends it.
std::vector<std::string> flag_texts(std::uint32_t flags);

/// Counts and measures of contact in one interval.
struct ContactReport {
  std::uint64_t candidates = 0;      ///< particle–triangle pairs whose boxes met
  std::uint64_t contacts = 0;        ///< active records
  std::uint64_t impacts = 0;         ///< bad pairs found by detection in the impulse rounds
  std::uint64_t ccd_iterations = 0;  ///< rounds of impulses at meetings
  std::uint64_t zone_rounds = 0;
  std::uint64_t zone_points = 0;  ///< members of zones at the end
  std::uint64_t held = 0;         ///< points held (x1 = x0)
  std::uint64_t separated = 0;
  std::uint64_t stalled = 0;        ///< prescribed nodes held
  std::uint64_t carried_along = 0;  ///< particles saved by affine follow
  std::uint64_t removed = 0;        ///< particles given up
  std::uint64_t allowed = 0;        ///< particles that passed by policy
  std::uint64_t started_too_close =
      0;                        ///< contacts that began nearer than δ: what the promise does not cover
  std::uint64_t relocated = 0;  ///< particles moved out of, or removed at, a new surface
  double min_distance = std::numeric_limits<double>::infinity();  ///< end distance over all tested pairs [m]
  std::uint64_t crossings_found_by_verify =
      0;  ///< particles whose path touches a surface, or that end nearer than δ
  std::uint64_t verified_pairs = 0;
  Vec3 impulse_on_free_nodes = Vec3::Zero();  ///< [N s]
  /// Reactions of pins, static and kinematic nodes, and of particles of infinite mass [N s].
  Vec3 impulse_on_prescribed = Vec3::Zero();
  Vec3 momentum_removed = Vec3::Zero();  ///< carried away by particles given up [N s]
  double kinetic_energy_change = 0;      ///< of particles and free nodes, by impulses [J]

  void add(const ContactReport& o);
};

struct FluidReport {
  int iterations = 0;             ///< of the pressure solver
  int divergence_iterations = 0;  ///< DFSPH: of its divergence solver
  double density_error_mean = 0;  ///< positive part, relative, over particles whose error exceeds −tolerance
  double density_error_max = 0;   ///< relative
  bool converged = true;
  bool diverged = false;
  std::uint64_t hidden_pairs = 0;  ///< pairs of neighbours parted by a surface
};

/// Of two sub-steps together: counts add up, of the errors the larger, and what either gave up. The last
/// sub-step alone would hide a bad one before it.
FluidReport worst_of(const FluidReport& a, const FluidReport& b);

/// Where a step was cut into sub-steps, counts and exchanges are their sums, `fluid` is their worst_of(), and
/// `alive`, momentum before and after are those of the whole step.
struct StepReport {
  Status status;  ///< refused: nothing was done
  std::vector<std::string> messages;
  std::uint64_t step = 0;
  double time = 0;  ///< simulated, after the step [s]
  double dt = 0;
  int substeps = 0;  ///< certified intervals that the step was cut into
  StageSeconds seconds;
  FluidReport fluid;
  ContactReport contact;
  std::uint64_t alive = 0, emitted = 0, removed = 0, removed_invalid = 0, blocked_starts = 0;  ///< particles
  double mass_emitted = 0, mass_removed = 0;                                                   ///< [kg]
  Vec3 momentum_before = Vec3::Zero();  ///< of the fluid [N s]
  Vec3 momentum_after = Vec3::Zero();
  Vec3 momentum_emitted = Vec3::Zero();
  Vec3 momentum_removed = Vec3::Zero();  ///< kill box, quarantine and contact's removals
  Vec3 momentum_gravity = Vec3::Zero();  ///< given by gravity
  std::uint32_t flags = 0;               ///< StepFlag bits

  /// Σ after − before − emitted + removed − gravity + what the surfaces got (C.28): zero up to rounding.
  Vec3 momentum_residual() const;
};

}  // namespace oilskin
