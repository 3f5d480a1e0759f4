/// Contact alone: corrects the proposed motion of any particles and any triangle meshes so that no particle
/// crosses a triangle. Needs neither our fluid nor Bullet.
#pragma once

#include <memory>

#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"

namespace oilskin {

/// Particles over one interval. The spans view the caller's arrays and have the same length.
struct ParticleMotion {
  Span<const std::uint64_t> id;     ///< unique
  Span<const Vec3> x_t0;            ///< start [m]
  Span<Vec3> x_t1;                  ///< proposed end [m]; corrected
  Span<Vec3> velocity;              ///< at the end [m/s]; corrected by adding impulses
  Span<const double> inverse_mass;  ///< [1/kg], ≥ 0; 0 = immovable
  Span<std::uint8_t> removed;       ///< output: 1 = given up by policy, its path is not certified
  double spacing = 0.005;      ///< dx [m]: how far off a record may act; also the area dx² of a wall contact
  double rest_density = 1000;  ///< [kg/m³] and
  double viscosity = 0;  ///< kinematic [m²/s]: for SlipModel::viscous_wall, whose μ_f is their product
};

/// A particle near a triangle at the start of the interval, by closest feature (C.2): after [Bridson2002],
/// with the closest point in place of the plane test of [Huber2013] Eq. 1.
struct Contact {
  std::uint32_t particle = 0;  ///< index into ParticleMotion
  std::uint32_t surface = 0;   ///< index into the list of surfaces
  std::uint32_t triangle = 0;
  std::uint64_t feature =
      0;  ///< vertex, edge or face of the surface; the same for all triangles that share it
  std::array<std::uint32_t, 3> nodes{};  ///< of the triangle
  std::array<double, 3> weights{};       ///< barycentric, Σ = 1
  Vec3 normal = Vec3::Zero();            ///< from the feature to the particle, unit
  double distance = 0;                   ///< d0 at the start [m]
  bool back = false;  ///< on the side that the surface's normals turn away from (SurfaceSettings::slip_back)
  /// How squarely the surface faces the particle: the largest |cos| between `normal` and the normals of the
  /// triangles at the feature. 1 over faces and inner edges of a flat sheet, 0 in the plane beyond a border.
  double normal_alignment = 1;
};

/// Finds contacts, solves their constraints, resolves impacts, and certifies the result.
///
/// After resolve() returns an accepted status with ccd and zones on, for every particle that is not `removed`
/// the straight motion x_t0 → x_t1 keeps a distance > 0 from the straight motion of every triangle, and ends
/// no nearer than δ — provided it began no nearer than δ.
///
/// One thread at a time may call a solver; different solvers are independent. It calls nothing of the
/// caller's. If resolve() throws (std::bad_alloc, std::runtime_error where FCL has no memory,
/// std::length_error beyond 2^32 candidate pairs), the solver can be used again; x_t0 is as it was, the ends,
/// velocities and impulses in `particles` and `surfaces` have no meaning.
class ContactSolver {
 public:
  explicit ContactSolver(const ContactSettings& settings = {}, int threads = 0);
  ~ContactSolver();
  ContactSolver(ContactSolver&&) noexcept;
  ContactSolver& operator=(ContactSolver&&) noexcept;

  const ContactSettings& settings() const;
  Status set_settings(const ContactSettings& settings);

  /// One interval of length dt [s] > 0. Refuses non-finite or mismatched input, naming the array and the
  /// index. `surfaces` need different ids, δ and thickness set; x_t0 and x_t1 must be stored numbers. Ends,
  /// velocities and impulses are in `particles` and `surfaces` afterwards; the caller goes on from there.
  Status resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                 ContactReport& report, StageSeconds& seconds);
  Status resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                 ContactReport& report) {
    StageSeconds seconds;
    return resolve(dt, particles, surfaces, report, seconds);
  }

  /// The contacts of the last resolve() that had a constraint.
  const std::vector<Contact>& contacts() const;

  /// Independent of resolve(): counts the particles whose path meets a triangle or that end nearer than δ, by
  /// sweep and prune over all pairs and additive continuous collision detection [Li2021].
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
