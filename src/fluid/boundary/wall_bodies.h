/// Rigid bodies that yield under the pressure of the particles at their hulls (docs/theory/boundary.md,
/// section 7).
#pragma once

#include "core/parallel.h"
#include "fluid/boundary/load_memory.h"
#include "fluid/boundary/wall_geometry.h"

namespace oilskin::fluid {

/// A force or impulse and its moment about the centre of mass of a body, or a velocity and an angular
/// velocity.
struct Wrench {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();

  void operator+=(const Wrench& o) {
    linear += o.linear;
    angular += o.angular;
  }
  Wrench times(double f) const { return {f * linear, f * angular}; }
  double dot(const Wrench& o) const { return linear.dot(o.linear) + angular.dot(o.angular); }
};

/// How walls of bodies respond: what the nodes of sheets do each for itself, the nodes of a body do together.
class WallBodies {
 public:
  /// particle_mass [kg], dt of the interval [s], `passed`: from the start of the step to its end [s].
  void build(const WallGeometry& geometry, Span<SurfaceMotion* const> surfaces, const LoadMemory& memory,
             double passed, double dt, double particle_mass, const Workers& workers);

  /// There is no body at any wall.
  bool empty() const { return bodies_.empty(); }

  /// The velocities that the bodies get, beyond what the host proposes, from wall pressures theta + depth d_T
  /// [m/s] per point (B.13), from gravity, from the load that the host does not carry, and from the load of
  /// the sub-steps before (B.39).
  void predict(const std::vector<float>& theta, const std::vector<float>& depth, const Workers& workers);
  /// The velocities from a change of theta: m M⁻¹ Σ θ_k g_k.
  void respond(const std::vector<float>& theta, const Workers& workers);
  /// Σ_T γ_T·v_T of a point at these velocities.
  float flux_at(std::size_t point) const;

  /// Adds the sums of |Y_kl| over the bodies of each point (B.40).
  void add_row_sums(std::vector<float>& rows) const;

 private:
  struct Body {
    Vec3 inverse_mass;
    Eigen::Matrix3d inverse_inertia;
    Wrench before;                         // velocity without the pressures of this interval
    Vec3 down;                             // along gravity
    double yields;                         // there, the root of what is not firm (B.45)
    std::vector<std::uint32_t> couplings;  // in the order of the points

    Wrench velocity_from(const Wrench& impulse) const {
      return {yielding(inverse_mass.cwiseProduct(yielding(impulse.linear))),
              inverse_inertia * impulse.angular};
    }
    Vec3 yielding(const Vec3& v) const { return v - (1 - yields) * v.dot(down) * down; }
  };
  /// Of a point and a body whose walls it sees.
  struct Coupling {
    std::uint32_t point, body;
    Wrench gamma;        // g: Σ_T γ_T and its moment
    Wrench depth_gamma;  // Σ_T d_T γ_T and its moment
  };

  void add_bodies(Span<SurfaceMotion* const> surfaces, const LoadMemory& memory, double passed, double dt);
  void couple(const WallGeometry& geometry, Span<SurfaceMotion* const> surfaces);
  Wrench sum_over(const Body& body, const std::vector<float>& theta, const std::vector<float>* depth,
                  const Workers& workers) const;

  double mass_ = 0;                        // of a particle [kg]
  std::vector<std::uint32_t> of_surface_;  // body, or none
  std::vector<Body> bodies_;
  std::vector<Coupling> couplings_;   // in the order of the points
  std::vector<std::uint32_t> begin_;  // per point, and one more
  std::vector<Wrench> velocity_;      // per body
};

}  // namespace oilskin::fluid
