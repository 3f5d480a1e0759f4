/// @file
/// Settings: plain structs with all defaults. Each field has its unit, its range and its effect. validate()
/// names the first field that is out of range, its value and its range.
#pragma once

#include <optional>

#include "oilskin/types.h"

namespace oilskin {

/// How the fluid computes its pressure.
enum class PressureSolver {
  /// State equation p = k (ρ − ρ0) [Mueller2003], the reference of [Huber2013].
  mcg03,
  /// Predictive–corrective incompressible SPH [Solenthaler2009].
  pcisph,
  /// Divergence-free SPH [Bender2015].
  dfsph,
};

/// What a surface within the support radius of a particle adds to its density and pressure.
enum class BoundaryModel {
  /// Nothing, as in [Huber2013]: the first layer lacks half of its neighbours.
  contact_only,
  /// Each wall continues the water as its mirror image (pcisph, dfsph).
  mirrored,
};

/// Settings of the fluid.
struct FluidSettings {
  /// The rest distance dx of particles [m], 1e-6 … 1e3.
  double spacing = 0.005;
  /// The rest density ρ0 [kg/m³], 1e-6 … 1e9.
  double rest_density = 1000;
  /// Support radius over spacing, H/dx, 1.5 … 4, with mirrored walls 1.5 … 2.5. PCISPH's ω falls as it grows.
  double support_ratio = 2;
  /// The pressure solver.
  PressureSolver solver = PressureSolver::dfsph;
  /// PCISPH, DFSPH: the mean positive density error, relative, at which the iterations end, ≥ 0.
  double tolerance = 1e-3;
  /// DFSPH: the mean compression beyond ρ0 per step, relative, at which the divergence iterations end, ≥ 0.
  double divergence_tolerance = 1e-3;
  /// PCISPH, DFSPH: ≥ 1.
  int min_iterations = 3;
  /// PCISPH, DFSPH: ≥ min_iterations. A step that reaches it is counted.
  int max_iterations = 50;
  /// DFSPH: the share of the correction of kernel gradients [Bonet1999] (F.77), 0 … 1; 0 = none. Without it,
  /// water under pressure resists shear like a solid.
  double gradient_correction = 1;
  /// MCG03: k [m²/s²], > 0. The speed of sound is √k, so a step longer than 0.4 H/(√k + v) is cut into fluid
  /// sub-steps. A longer sub-step sets flag_sound_too_fast; one above 0.4 H/√k lowers k to (0.4 H/dt)².
  double stiffness = 4;
  /// The kinematic viscosity ν [m²/s], ≥ 0; 0 = none. Explicit: a step longer than 0.035 H²/ν is cut into
  /// fluid sub-steps. Where max_substeps does not allow as many, the viscosity is limited to what is stable,
  /// with flag_viscosity_limited.
  double viscosity = 1e-6;
  /// The XSPH smoothing rate ν_x [1/s], ≥ 0; its factor per step is 1 − exp(−ν_x dt); 0 = none. Absent:
  /// default_xsph_rate() of the spacing and of the gravity with which the world is made.
  std::optional<double> xsph_rate;
  /// The rate of a pair is greater by this factor times |v_ij·x_ij|/(|x_ij| dx), ≥ 0 (F.81); 0 = none. It
  /// damps what approaches or leaves its neighbours, and no rotation. Absent: 1 where xsph_rate is absent,
  /// too, and otherwise 0.
  std::optional<double> xsph_strain;
  /// PCISPH, DFSPH: predicted positions stay in front of sheets in contact (F.36).
  bool contact_aware = true;
  /// Neighbours whose connecting segment crosses a surface are left out of every sum.
  bool occlusion = true;
  /// With mirrored, walls carry the water by its pressure: levels and forces are right. With contact_only,
  /// the model of [Huber2013], columns stand 17 to 24 % too low.
  BoundaryModel boundary = BoundaryModel::mirrored;
  /// The largest displacement within a fluid sub-step, in spacings, > 0.
  double cfl = 1;
  /// The largest number of fluid sub-steps of a step, 1 … 1000; each is an interval with its own certificate.
  /// Displacements (cfl), viscosity, the speed of sound (mcg03) and, with boundary terms, water at rest ask
  /// for them.
  int max_substeps = 8;
  /// The fluid touches surfaces whose collision_mask has a bit of this group …
  std::uint32_t collision_group = 1;
  /// … and whose collision_group has a bit of this mask.
  std::uint32_t collision_mask = 0xffffffffu;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

/// The slip law: the tangential part of contact.
enum class SlipModel {
  /// No tangential impulse: inviscid.
  free,
  /// |J_t| ≤ μ J_n; μ = 1 is Eq. 8 of [Huber2013]. J_n is the normal impulse of contact and of the wall
  /// pressure of boundary terms together.
  coulomb,
  /// The first layer, which contact or wall pressure carries, moves with the sheet. With contact alone the
  /// wall is effectively half a spacing inside the fluid: in a channel of 10 particles the velocity in the
  /// middle is a fifth too small. With boundary terms a layer that lies in the viscous sublayer (y⁺ < 5) has
  /// the drag of viscous_wall, so that flows of thick liquids are of second order in dx.
  sticking,
  /// Wall shear μ_f v_t/(z + ℓ) on the first layer, z < dx, implicit: no slip of a viscous fluid, of second
  /// order in dx. It is proportional to the viscosity, so its effect on water at 5 mm is small.
  viscous_wall,
};

/// The slip law of one side of a surface.
struct SlipSettings {
  /// The law.
  SlipModel model = SlipModel::free;
  /// Coulomb: μ, ≥ 0; infinity sticks.
  double friction = 1;
  /// Viscous wall: ℓ [m], ≥ 0; 0 = no slip, infinity = free.
  double slip_length = 0;
};

/// ν_x of a fluid whose settings name none, 0.5 √(g/dx) [1/s] (F.73); g = |gravity| [m/s²].
double default_xsph_rate(double spacing, double g);
/// Sets xsph_rate and xsph_strain where they are absent; g = |gravity| [m/s²].
void set_smoothing(FluidSettings& fluid, double g);

/// The thickness h of a surface whose settings name none, dx/5 [m].
double default_thickness(double spacing);

/// Settings of one attached surface.
struct SurfaceSettings {
  /// The thickness h [m], > 0 and < 1e15: the distance that contact keeps. Below 4 δ it is refused (δ:
  /// minimum_separation()). Absent: default_thickness() of the fluid's spacing.
  std::optional<double> thickness;
  /// The slip law of the front: the side that the triangles' normals point to (right-hand rule).
  SlipSettings slip;
  /// The slip law of the back; absent = as `slip`.
  std::optional<SlipSettings> slip_back;
  /// The triangles stand for a smooth sheet: what slides round an edge between them keeps its speed. Where
  /// off, the next triangle stops a part of it: a film that N triangles turn by 180° keeps cos^N(π/N). No
  /// approach that is flatter than the neighbouring triangles' angle is damped. Edges of more than 60° stay
  /// edges.
  bool smooth = false;
  /// The triangles, closed and all with normals outwards or all inwards, enclose a solid: no particle starts
  /// inside, and what is inside where it appears, or after a teleport, is removed (ContactReport::relocated).
  /// Absent: as the host says (SurfaceMotion::solid); Bullet's convex shapes and compounds of them are solid.
  std::optional<bool> solid;
  /// The surface touches a fluid whose collision_mask has a bit of this group …
  std::uint32_t collision_group = 1;
  /// … and whose collision_group has a bit of this mask.
  std::uint32_t collision_mask = 0xffffffffu;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

/// How contact restores the thickness.
enum class Repulsion {
  /// Position constraints within the Gauss–Seidel iterations; they add no velocity.
  split,
  /// Velocity impulses min(k d dt, m_eff (0.1 d/dt − v_n)) of [Bridson2002], as in [Huber2013].
  bridson,
  /// None: inelastic stop only.
  none,
};

/// What happens to a particle that prescribed surfaces close on.
enum class Infeasible {
  /// Pins that may be held are held for the interval and counted; at other nodes the particle is removed.
  stall,
  /// The particle is removed; the report has its mass and momentum.
  remove,
  /// The particle passes and is counted as a leak.
  allow,
};

/// What refits and searches the trees of triangles that FCL builds. Both find the same pairs.
enum class Hierarchy {
  /// A copy of FCL's tree in one array; faster.
  flat,
  /// FCL's own nodes.
  fcl,
};

/// Settings of contact.
struct ContactSettings {
  /// How contact restores the thickness.
  Repulsion repulsion = Repulsion::split;
  /// Bridson: k [N/m], ≥ 0.
  double stiffness = 1000;
  /// Predicted approach and continuous test. Off: repulsion by proximity at the start of each step alone,
  /// which leaks (Fig. 4, left, of [Huber2013]); no crossing is excluded.
  bool ccd = true;
  /// Impact zones. Off: no crossing is excluded.
  bool zones = true;
  /// Gauss–Seidel iterations, 1 … 1000. More of them make simultaneous impacts more accurate, and slower.
  int solver_iterations = 5;
  /// Iterations of continuous test and impulses before impact zones, 0 … 100.
  int ccd_iterations = 5;
  /// What happens to a particle that prescribed surfaces close on.
  Infeasible infeasible = Infeasible::stall;
  /// Check every interval again by an independent algorithm and count crossings.
  bool verify = false;
  /// What searches for pairs. The results do not depend on it.
  Hierarchy hierarchy = Hierarchy::flat;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

/// Settings of the world.
struct WorldSettings {
  /// [m/s²], in any direction.
  Vec3 gravity = Vec3(0, -9.81, 0);
  /// Particles that leave it are removed and counted. Its largest absolute coordinate R enters δ (C.1): at
  /// ±10 m a host of floats may have thicknesses down to 0.31 mm, at ±100 m down to 3.1 mm.
  Box kill_box = {Vec3::Constant(-10), Vec3::Constant(10)};
  /// 0 = all hardware threads, or those of set_job_system(). The results do not depend on it.
  int threads = 0;
  /// Where there are as many particles, none is added; 0 = no limit. Starts of emitters are lost then, and
  /// counted in StepReport::limited_starts; surfaces keep what they would release; add_particles() leaves out
  /// the rest. Emission goes on when particles have left. A smaller limit removes no particle.
  std::uint64_t max_particles = 0;
  /// Wall time for World::step() [s], ≥ 0; 0 = no limit. A step that would take longer, judged by those
  /// before, leaves out iterations of the pressure solver, down to FluidSettings::min_iterations, and then
  /// fluid sub-steps, down to those that water at rest and stability need; StepReport has the numbers. A step
  /// may still be longer: fewer particles help then. The water gets denser at impacts; nothing crosses. The
  /// results depend on the speed of the machine.
  double step_budget = 0;

  /// Accepted, or the first field that is out of range.
  Status validate() const;
};

}  // namespace oilskin
