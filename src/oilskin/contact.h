/// Contact alone: corrects the proposed motion of any particles and any triangle meshes so that no particle
/// crosses a triangle. Needs neither our fluid nor Bullet.
#pragma once

#include <memory>

#include "oilskin/report.h"
#include "oilskin/settings.h"
#include "oilskin/surface_motion.h"

namespace oilskin {

class Workers;

/// n particles over one interval. Spans point to the caller's arrays, all of the same length.
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

/// Runs the loop: records → impulses → meetings → zones → certificate.
///
/// After resolve() returns an accepted status with ccd and zones on, for every particle that is not `removed`
/// the straight motion x_t0 → x_t1 keeps a distance > 0 from the straight motion of every triangle, and ends
/// no nearer than δ — provided it began no nearer than δ.
class ContactSolver {
 public:
  explicit ContactSolver(const ContactSettings& settings = {}, int threads = 0);
  ContactSolver(const ContactSettings& settings, std::shared_ptr<Workers> workers);
  ~ContactSolver();
  ContactSolver(ContactSolver&&) noexcept;
  ContactSolver& operator=(ContactSolver&&) noexcept;

  const ContactSettings& settings() const;
  Status set_settings(const ContactSettings& settings);

  /// One interval of length dt [s] > 0. Refuses non-finite or mismatched input, naming the array and the
  /// index. `surfaces` need id, δ and thickness set; x_t0 and x_t1 must be stored numbers. Ends, velocities
  /// and impulses are in `particles` and `surfaces` afterwards; the caller goes on from there.
  Status resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                 ContactReport& report, StageSeconds& seconds);
  Status resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                 ContactReport& report) {
    StageSeconds seconds;
    return resolve(dt, particles, surfaces, report, seconds);
  }

  /// The records at the start positions alone, ordered by particle, surface and feature, using x_t1 as the
  /// predicted sweep. Valid until the next call.
  const std::vector<Contact>& find_contacts(const ParticleMotion& particles,
                                            Span<SurfaceMotion* const> surfaces);

  /// The active records of the last resolve(): who was hit, where.
  const std::vector<Contact>& contacts() const;

  /// Independent of resolve(): counts the particles whose path meets a triangle or that end nearer than δ, by
  /// sweep and prune over all pairs and additive continuous collision detection [Li2021].
  static std::uint64_t count_crossings(const ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                                       std::uint64_t* pairs_tested = nullptr);

  /// Forgets what is cached for a surface (its tree).
  void forget(std::uint64_t surface_id);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin
