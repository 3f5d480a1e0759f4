/// @file
/// Contact alone: corrects the proposed motion of any particles and any triangle meshes so that no particle
/// crosses a triangle. It needs neither Oilskin's fluid nor Bullet.
#pragma once

#include <memory>

#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"

namespace oilskin {

/// Particles over one interval. The spans view the caller's arrays and have the same length.
struct ParticleMotion {
  /// Unique numbers.
  Span<const std::uint64_t> id;
  /// Positions at the start [m].
  Span<const Vec3> x_t0;
  /// Proposed positions at the end [m]; corrected.
  Span<Vec3> x_t1;
  /// Velocities at the end [m/s]; corrected by adding impulses.
  Span<Vec3> velocity;
  /// [1/kg], ≥ 0; 0 = immovable.
  Span<const double> inverse_mass;
  /// Output: 1 = removed by policy, its path is not certified.
  Span<std::uint8_t> removed;
  /// The rest distance dx [m]: up to it a contact acts, and dx² is its area at a viscous wall.
  double spacing = 0.005;
  /// ρ0 [kg/m³], for SlipModel::viscous_wall, whose dynamic viscosity μ_f is ρ0 ν.
  double rest_density = 1000;
  /// The kinematic viscosity ν [m²/s], for SlipModel::viscous_wall.
  double viscosity = 0;
};

/// A particle close to a surface at the start of the interval, at a local minimum of its distance: after
/// [Bridson2002], with the closest point in place of the plane test of [Huber2013] Eq. 1.
struct Contact {
  /// Index into ParticleMotion.
  std::uint32_t particle = 0;
  /// Index into the list of surfaces.
  std::uint32_t surface = 0;
  /// Index into the triangles of the surface.
  std::uint32_t triangle = 0;
  /// The vertex, edge or face of the surface; the same for all triangles that share it.
  std::uint64_t feature = 0;
  /// The nodes of the triangle.
  std::array<std::uint32_t, 3> nodes{};
  /// The barycentric weights of the closest point, Σ = 1.
  std::array<double, 3> weights{};
  /// From the feature to the particle, unit (C.2).
  Vec3 normal = Vec3::Zero();
  /// The distance d₀ at the start [m].
  double distance = 0;
  /// Whether the particle is on the back, where SurfaceSettings::slip_back holds.
  bool back = false;
  /// The largest |cos| between `normal` and the normals of the triangles at the feature (C.7): 1 at faces and
  /// inner edges of a flat sheet, 0 beside a border in the plane of the sheet.
  double normal_alignment = 1;
};

/// Finds contacts, solves their constraints, resolves impacts, and certifies the result.
///
/// After resolve() is accepted with ContactSettings::ccd and zones on, the straight motion x_t0 → x_t1 of
/// every particle that is not `removed` keeps a distance > 0 from the straight motion of every triangle, and
/// ends no closer than δ, if it started no closer than δ.
///
/// One thread at a time may call a solver; different solvers are independent. It calls nothing of the
/// caller's. If resolve() throws (std::bad_alloc, std::runtime_error where FCL has no memory,
/// std::length_error beyond 2^32 candidate pairs), the solver can be used again; x_t0 is as it was, the ends,
/// velocities and impulses in `particles` and `surfaces` have no meaning.
class ContactSolver {
 public:
  /// `threads`: 0 = all hardware threads, or those of set_job_system(); the results do not depend on it.
  /// Settings are validated by resolve().
  explicit ContactSolver(const ContactSettings& settings = {}, int threads = 0);
  ~ContactSolver();
  /// Takes over settings, caches and contacts.
  ContactSolver(ContactSolver&&) noexcept;
  /// Takes over settings, caches and contacts.
  ContactSolver& operator=(ContactSolver&&) noexcept;

  /// The settings.
  const ContactSettings& settings() const;
  /// Refuses settings that are out of range.
  Status set_settings(const ContactSettings& settings);

  /// One interval of length dt [s] > 0. Refuses numbers that are not finite and arrays of different lengths,
  /// with the name of the array and the index. `surfaces` need different ids, δ and thickness; x_t0 and x_t1
  /// must be stored numbers. The results are in `particles` and `surfaces`.
  Status resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                 ContactReport& report, StageSeconds& seconds);
  /// The same without times.
  Status resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                 ContactReport& report) {
    StageSeconds seconds;
    return resolve(dt, particles, surfaces, report, seconds);
  }

  /// The contacts of the last resolve() that had a constraint.
  const std::vector<Contact>& contacts() const;

  /// Counts the particles whose path touches a triangle or that end closer than δ. Shares no algorithm with
  /// resolve(): sweep and prune over all pairs, and additive continuous collision detection [Li2021].
  static std::uint64_t count_crossings(const ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                                       std::uint64_t* pairs_tested = nullptr);

  /// Forgets what is kept of a surface from call to call: its tree and the analysis of its mesh. Results do
  /// not depend on it. A changed mesh needs a new id, or this call.
  void forget(std::uint64_t surface_id);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin
