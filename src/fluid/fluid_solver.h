/// SPH: from positions and velocities at the start of a step to velocities at its end, before contact.
#pragma once

#include <memory>

#include "core/archive.h"
#include "core/parallel.h"
#include "fluid/particles.h"
#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

/// A one-sided bound on predicted velocities: v*·normal ≥ min_normal_velocity. For a particle at distance
/// d0 of a sheet of thickness h that moves with v_w: least = v_w·n − max(0, d0 − h)/dt. Keeps the prediction
/// of PCISPH on its side of the sheet (F.36); gives no impulse to anything.
struct PredictionContact {
  std::uint32_t particle = 0;
  Vec3 normal = Vec3::Zero();
  double min_normal_velocity = 0;  ///< [m/s]
};

class FluidSolver {
 public:
  /// Settings must be valid.
  FluidSolver(const FluidSettings& settings, std::shared_ptr<Workers> workers);
  ~FluidSolver();

  /// Lattice calibrated: ρ0 / Σ W over the cubic lattice of spacing dx [kg].
  double particle_mass() const;
  double support_radius() const;  ///< H [m]

  /// Puts the particles into cell order and finds the neighbours within H. Equal input order → equal output
  /// order.
  void prepare(Particles& particles, StageSeconds& seconds);

  /// After prepare(), for the same particles: what the surfaces do to the pair sums, as the settings ask:
  /// hides neighbours behind them, finds boundary terms. They move from x_t0 to x_t1 within dt [s] and are
  /// kept until propose(), which may change their velocities and impulses: what boundary terms give to
  /// particles, nodes lose.
  void apply_surfaces(double dt, const Vec3& gravity, const Particles& particles,
                      Span<SurfaceMotion* const> surfaces, StageSeconds& seconds);

  /// What surfaces did with the last step's load, and what load they get in this one: boundary terms foresee
  /// how light cloth answers. Once per step, after all surfaces were gathered and before they are scattered.
  void record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces);
  void record_load(double dt, Span<SurfaceMotion* const> surfaces);

  /// After prepare(), for the same particles: density and pressure of the start positions, and
  /// velocity ← particles.velocity + dt (gravity + viscosity + pressure). Positions stay. Pair forces are
  /// antisymmetric and summed in double, so that the fluid's momentum changes by gravity alone, up to 1e-12
  /// relative. `contacts` sorted by particle. `velocity` has one value per particle and may be
  /// particles.velocity itself.
  ///
  /// Particles that were appended since prepare() take no part in the sums; nothing of them changes.
  void propose(double dt, const Vec3& gravity, Particles& particles, Span<const PredictionContact> contacts,
               Span<Vec3> velocity, FluidReport& report, StageSeconds& seconds);

  /// For a step that may fail: checkpoint() copies what is kept from step to step, roll_back() puts it back.
  void checkpoint();
  void roll_back() noexcept;

  /// What is kept from step to step besides the particles.
  void visit(Archive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin::fluid
