/// SPH: from positions and velocities at the start of a step to velocities at its end, before contact.
#pragma once

#include <memory>

#include "core/archive.h"
#include "core/mesh_topology.h"
#include "core/parallel.h"
#include "fluid/boundary/load_memory.h"
#include "fluid/boundary/wall_geometry.h"
#include "fluid/boundary/wall_impulse.h"
#include "fluid/particles.h"
#include "fluid/pressure/prediction_contact.h"
#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

class FluidSolver {
 public:
  /// Settings must be valid.
  FluidSolver(const FluidSettings& settings, std::shared_ptr<Workers> workers);
  ~FluidSolver();

  /// Calibrated on the cubic lattice of spacing dx (F.6) [kg].
  double particle_mass() const;
  double support_radius() const;  ///< H [m]

  /// Puts the particles into cell order and finds the neighbours within H. Equal input order → equal output
  /// order.
  void prepare(Particles& particles, StageSeconds& seconds);

  /// After prepare(), for the same particles: boxes that contain all of them, each a few H wide [m].
  std::vector<Box> boxes(const Particles& particles) const;

  /// After prepare(), for the same particles. As the settings say, removes neighbours hidden by surfaces and
  /// finds the boundary terms. The surfaces move from x_t0 to x_t1 within dt [s], which end when `passed` [s]
  /// of the step have passed. They are kept until
  /// propose(), which changes their velocities and impulses: boundary terms give the nodes the momentum
  /// opposite to that of the particles. `topologies` are those of the surfaces, in their order. `near`:
  /// per surface, ascending, at least the triangles that are within H of a particle at x_t0; empty = all
  /// are looked at.
  void apply_surfaces(double passed, double dt, const Vec3& gravity, const Particles& particles,
                      Span<SurfaceMotion* const> surfaces, Span<const MeshTopology* const> topologies,
                      Span<const TriangleList> near, StageSeconds& seconds);
  /// After apply_surfaces(), with the same other arguments: the parts of the surfaces that each particle
  /// sees, at least those within `reach` [m] and H. Valid until the next prepare().
  const WallGeometry& find_visible_walls(double reach, double dt, const Vec3& gravity,
                                         const Particles& particles, Span<SurfaceMotion* const> surfaces,
                                         Span<const MeshTopology* const> topologies,
                                         Span<const TriangleList> near);

  /// Load memory of the boundary terms and of dry friction: the hosts' response to the load of the last step,
  /// and the load of this one. Once per step each, after all surfaces were gathered and before they are
  /// scattered. Surfaces that are not in the list are forgotten.
  void record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces);
  void record_load(double dt, Span<SurfaceMotion* const> surfaces,
                   Span<const std::vector<Vec3>> of_others = {});
  const LoadMemory& load_memory() const;

  /// After prepare(), for the same particles: density and pressure of the start positions, and
  /// velocity ← particles.velocity + dt (gravity + viscosity + pressure). Positions do not change. Pair
  /// forces are antisymmetric and summed in double: without boundary terms only gravity changes the fluid's
  /// momentum, up to 1e-12 relative. `contacts` sorted by particle. `velocity` has one value per
  /// particle; it may be particles.velocity itself.
  ///
  /// `acceleration`: of effects, one per particle [m/s²], or none; acts like gravity.
  ///
  /// Particles that were appended since prepare() take no part, and nothing of them changes.
  void propose(double dt, const Vec3& gravity, Particles& particles, Span<const PredictionContact> contacts,
               Span<const Vec3> acceleration, Span<Vec3> velocity, FluidReport& report,
               StageSeconds& seconds);

  /// After prepare(): the neighbours of a particle, less those that apply_surfaces() found hidden. None of
  /// one that was appended since.
  Span<const std::uint32_t> neighbours(std::size_t particle) const;

  /// From now on at most so many iterations of the pressure solver in propose(), at least min_iterations.
  void limit_iterations(int most);

  /// From now on the slopes of the kernel are stored for so many particles, and at walls. The others are
  /// computed when they are needed: this saves 160 bytes a particle, and gives the same bits. For tests and
  /// measurements.
  void store_slopes_of(std::size_t particles);

  /// What boundary terms gave to particles at walls with friction in the last propose(), ordered by particle.
  Span<const WallImpulse> wall_impulses() const;
  /// The same of those at solid bodies.
  Span<const WallImpulse> body_impulses() const;

  /// For a step that may fail: checkpoint() copies what is kept from step to step, roll_back() restores it.
  void checkpoint();
  void roll_back() noexcept;

  /// What is kept from step to step, apart from the particles.
  void visit(Archive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin::fluid
