/// Boundary terms: what the surfaces near a fluid add to its density and pressure (docs/theory/boundary.md).
///
/// A pressure model uses them in three places: λ_i counts in the density at the start; the density grows at
/// the rate −(1/H) Σ_T γ_T·(v_i − v_T) (B.12); and the pressure of particle i changes its velocity by
/// Σ_T θ_T γ_T (B.13). The nodes of the walls get the opposite momentum (B.14).
#pragma once

#include "fluid/boundary/load_memory.h"
#include "fluid/boundary/wall_compliance.h"
#include "fluid/boundary/wall_geometry.h"
#include "fluid/boundary/wall_impulse.h"
#include "fluid/boundary/wall_nodes.h"

namespace oilskin::fluid {

class Boundary {
 public:
  static constexpr std::uint32_t none = WallGeometry::none;

  /// `support_ratio` H/dx of the lattice.
  explicit Boundary(double support_ratio) : geometry_(MirrorImage(support_ratio)) {}

  /// Finds the points and walls of an interval. The surfaces are kept until apply_load() or clear().
  void find(const BoundaryInput& input, const Workers& workers);
  void clear();

  bool empty() const { return points().empty(); }
  const std::vector<WallPoint>& points() const { return geometry_.points(); }
  Span<const ImagePlane> images_of(std::size_t point) const { return geometry_.images_of(point); }
  const std::vector<Wall>& walls() const { return geometry_.walls(); }
  const WallGeometry& geometry() const { return geometry_; }
  /// Index into points(), or none. Valid for every particle if !empty().
  std::uint32_t point_of(std::size_t particle) const { return geometry_.point_of()[particle]; }

  WallCompliance& compliance() { return compliance_; }
  /// Whether a rigid body is among the walls.
  bool has_bodies() const { return !compliance_.bodies().empty(); }
  const std::vector<float>& normal_flux() const { return compliance_.normal_flux(); }

  /// dv += Σ_T θ_T γ_T; velocities and impulses of the nodes change by the opposite momentum. `mass_ratio`:
  /// of the particles, relative to a new one; empty = all are 1.
  void apply_load(const std::vector<WallLoad<double>>& load, Span<const float> mass_ratio,
                  std::vector<Vec3>& dv, const Workers& workers);

  /// What the last apply_load() gave to particles at walls with friction, ordered by particle.
  const std::vector<WallImpulse>& wall_impulses() const { return wall_impulses_; }
  /// The same of those at solid bodies.
  const std::vector<WallImpulse>& body_impulses() const { return body_impulses_; }

  /// What is kept from step to step.
  LoadMemory& memory() { return memory_; }
  const LoadMemory& memory() const { return memory_; }

 private:
  std::vector<WallNodeMotion> node_motion(double dt, const Workers& workers) const;
  void push_bodies(const std::vector<Vec3>& impulse);
  WallImpulse wall_impulse(const Wall& wall, const std::vector<WallLoad<double>>& load,
                           Span<const float> mass_ratio) const;
  void record_wall_impulses(const std::vector<WallLoad<double>>& load, Span<const float> mass_ratio);
  void record_body_impulses(const std::vector<WallLoad<double>>& load, Span<const float> mass_ratio);

  WallGeometry geometry_;
  WallNodes nodes_;
  WallCompliance compliance_;
  LoadMemory memory_;
  double mass_ = 0;  // of a new particle [kg]
  std::vector<SurfaceMotion*> surfaces_;
  std::vector<WallImpulse> wall_impulses_, body_impulses_;
};

}  // namespace oilskin::fluid
