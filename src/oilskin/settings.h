/// Settings: plain structs, every default in place. Each field says its unit, its range, and what happens
/// beyond. validate() names the first field that is wrong, its value and what would be right.
#pragma once

#include <optional>

#include "oilskin/types.h"

namespace oilskin {

enum class PressureSolver {
  mcg03,   ///< state equation p = k (ρ − ρ0) [Mueller2003], the reference of [Huber2013]
  pcisph,  ///< predictive–corrective incompressible SPH [Solenthaler2009]
  dfsph,   ///< divergence-free SPH [Bender2015]
};

/// What the density and pressure of a particle know of a surface within the support radius.
enum class BoundaryModel {
  contact_only,  ///< nothing, as in [Huber2013]: the first layer lacks half of its neighbours
  mirrored,  ///< each wall continues the water as its mirror image, in density and pressure (pcisph, dfsph)
};

struct FluidSettings {
  double spacing = 0.005;      ///< rest distance dx of particles [m], 1e-6 … 1e3
  double rest_density = 1000;  ///< ρ0 [kg/m³], 1e-6 … 1e9
  double support_ratio =
      2;  ///< support radius over spacing, H/dx, 1.5 … 4; PCISPH relaxes δ by ω as it grows
  PressureSolver solver = PressureSolver::pcisph;
  double tolerance = 1e-3;  ///< PCISPH, DFSPH: mean positive density error, relative, at which it stops, ≥ 0
  double divergence_tolerance = 1e-3;  ///< DFSPH: mean compression beyond ρ0 per step, relative, ≥ 0
  int min_iterations = 3;              ///< PCISPH, DFSPH, ≥ 1
  int max_iterations = 50;  ///< PCISPH, DFSPH, ≥ min_iterations; a step that ends here is counted
  double stiffness =
      4;  ///< MCG03: k [m²/s²], > 0; sound √k, so dt ≤ 0.4 H/(√k + v); longer steps lower it to (0.4 H/dt)²
  double viscosity = 1e-6;    ///< kinematic ν [m²/s], ≥ 0; 0 = none. Explicit: dt ≤ 0.035 H²/ν
  double xsph_rate = 10;      ///< XSPH smoothing ν_x [1/s], ≥ 0; per step 1 − exp(−ν_x dt); 0 = none
  bool contact_aware = true;  ///< PCISPH, DFSPH predict no position behind a sheet in contact (F.36)
  /// Nothing acts through a surface: neighbours whose connecting segment meets one are left out of every sum.
  bool occlusion = true;
  /// Mirrored: for water that rests or flows on sheets. The fluid takes three times as long; a jet comes off
  /// a rigid sheet with 1 to 3 % of its speed, and on light cloth the layer that it strikes is too dense.
  BoundaryModel boundary = BoundaryModel::contact_only;
  double cfl = 0.4;  ///< way of whatever is fastest within a sub-step, in spacings, > 0
  int max_substeps =
      1;  ///< fluid sub-steps of a step, 1 … 1000; each is an interval with its own certificate
  std::uint32_t collision_group = 1;           ///< meets surfaces whose mask has a bit of this group …
  std::uint32_t collision_mask = 0xffffffffu;  ///< … and whose group has a bit of this mask

  Status validate() const;
};

enum class SlipModel {
  free,  ///< no tangential impulse: inviscid
  /// |J_t| ≤ μ J_n; μ = 1 is [Huber2013] Eq. 8. J_n is contact's: water that boundary terms carry feels none
  coulomb,
  /// The tangential velocity of the first layer is the sheet's: a motionless layer, as if the wall stood half
  /// a spacing inside the fluid (the middle of a channel of 10 particles across is a fifth too slow).
  sticking,
  /// Wall shear μ_f u/(z + ℓ) on the first layer, z < dx, implicit: no slip of a viscous fluid, accurate to
  /// second order in the spacing. As weak as the fluid's viscosity: water at 5 mm hardly feels it.
  viscous_wall,
};

struct SlipSettings {
  SlipModel model = SlipModel::free;
  double friction = 1;     ///< coulomb: μ, ≥ 0; infinity sticks
  double slip_length = 0;  ///< viscous_wall: ℓ [m], ≥ 0; 0 = no slip, infinity = free
};

struct SurfaceSettings {
  double thickness =
      0.001;  ///< h [m], > 0: the distance that contact keeps; below 4 δ it is refused (δ: World::attach)
  SlipSettings slip;
  /// Of the back, the side that the triangles' normals (right-hand rule of a triangle's node order) turn away
  /// from; absent = as `slip`.
  std::optional<SlipSettings> slip_back;
  std::uint32_t collision_group = 1;
  std::uint32_t collision_mask = 0xffffffffu;

  Status validate() const;
};

enum class Repulsion {
  split,    ///< position rows inside the Gauss–Seidel, adds no velocity (default)
  bridson,  ///< velocity impulses min(k d dt, m_eff (0.1 d/dt − v_n)) of [Bridson2002], as in [Huber2013]
  none,     ///< inelastic stop only
};

/// What happens to a particle that prescribed surfaces close on.
enum class Infeasible {
  stall,   ///< pins that may be held are held for the interval, and counted; others: the particle is removed
  remove,  ///< the particle is removed; its mass and momentum are booked
  allow,   ///< the particle passes, counted as a leak
};

struct ContactSettings {
  Repulsion repulsion = Repulsion::split;
  double stiffness = 1000;  ///< bridson: k [N/m], ≥ 0
  /// Look along paths: predicted approach and continuous test. Off: repulsion by proximity at the start of
  /// each step alone, which leaks, as [Huber2013] Fig. 4 left shows; there is no promise.
  bool ccd = true;
  bool zones = true;  ///< impact zones. Off: there is no promise
  int solver_iterations =
      5;  ///< Gauss–Seidel sweeps, 1 … 1000: accuracy of simultaneous impacts against time
  int ccd_iterations = 5;  ///< rounds of impulses at meetings before zones, 0 … 100
  Infeasible infeasible = Infeasible::stall;
  bool verify = false;  ///< re-check every interval by an independent route and count crossings

  Status validate() const;
};

struct WorldSettings {
  Vec3 gravity = Vec3(0, -9.81, 0);  ///< [m/s²]; axis-agnostic
  /// Particles that leave it are removed and counted. Its largest |coordinate| R sets the rounding part of δ.
  /// At ±10 m a host of floats may have thicknesses down to 0.31 mm; at ±100 m down to 3.1 mm.
  Box kill_box = {Vec3::Constant(-10), Vec3::Constant(10)};
  int threads = 0;  ///< 0 = all hardware threads; the results do not depend on it

  Status validate() const;
};

}  // namespace oilskin
