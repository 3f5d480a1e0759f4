/// How walls move under the pressure of the particles (docs/theory/boundary.md, section 7).
#pragma once

#include <vector>

#include "fluid/boundary/wall_bodies.h"
#include "fluid/boundary/wall_nodes.h"

namespace oilskin::fluid {

/// Motion of a node in an interval: its velocity is velocity + inverse_mass (J − carried), J the impulse of
/// the wall loads (B.18).
struct WallNodeMotion {
  float inverse_mass = 0;                              ///< [1/kg]; 0 = prescribed
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  ///< proposed by the host [m/s]
  Eigen::Vector3f carried = Eigen::Vector3f::Zero();   ///< part of J that the host will carry [N s]

  bool is_still() const { return inverse_mass == 0 && velocity.isZero(0); }
};

class WallCompliance {
 public:
  /// `motion` per node; particle_mass [kg]. Starts with the wall velocities at zero pressure. `bodies` are
  /// built already.
  void build(const WallGeometry& geometry, const WallNodes& nodes, std::vector<WallNodeMotion> motion,
             double particle_mass, const Workers& workers);

  /// Rigid bodies among the walls.
  WallBodies& bodies() { return bodies_; }
  const WallBodies& bodies() const { return bodies_; }

  /// Wall velocities at the end of the interval if point k has the wall pressure theta[k] + depth[k] d_T
  /// [m/s]. d_T is 0 at free nodes, so only bodies read `depth`. Writes normal_flux().
  void predict_wall_velocity(const std::vector<float>& theta, const std::vector<float>& depth,
                             const Workers& workers);
  /// f_k = Σ_T γ_T·v_T per point [m/s] (B.19).
  const std::vector<float>& normal_flux() const { return normal_flux_; }

  /// Row sums of |∂f/∂θ|: an upper bound on the eigenvalues of the compliance matrix Y (B.20). 0 at
  /// prescribed walls.
  const std::vector<float>& row_sums() const { return row_sums_; }

  /// Solves x_k/step_k + scale Σ_l Y_kl x_l = r_k (B.21) for the changes x of the points' pressures, up to an
  /// error of about a third; `change` is r before and x after. x_k = 0 where step_k is 0.
  void solve(float scale, const std::vector<float>& step, std::vector<float>& change, const Workers& workers);

 private:
  /// Σ b_c γ_T over the walls that a point and a node have in common. `other` is the node in the list of a
  /// point, and the point in the list of a node.
  struct Coupling {
    std::uint32_t other;
    Eigen::Vector3f gamma;
  };
  using Couplings = KeyedLists<Coupling>;
  struct Chebyshev;

  void couple_points(const WallGeometry& geometry, const WallNodes& nodes, const Workers& workers);
  void couple_nodes(const Workers& workers);
  void sum_rows(const Workers& workers);
  void set_wall_velocity(const std::vector<float>& theta, const Workers& workers);
  bool yields() const { return has_free_nodes_ || !bodies_.empty(); }
  Eigen::Vector3f reaction_to(std::size_t node, const std::vector<float>& theta) const;
  float flux_at(std::size_t point, const std::vector<Eigen::Vector3f>& velocity) const;
  float max_row(float scale, const std::vector<float>& step) const;

  float mass_ = 0;  // of a particle [kg]
  bool has_free_nodes_ = false;
  WallBodies bodies_;
  std::vector<WallNodeMotion> motion_;
  Couplings of_point_, of_node_;
  std::vector<float> normal_flux_, row_sums_;
  std::vector<Eigen::Vector3f> wall_velocity_;  // of every node

  // Of solve()
  std::vector<float> solve_step_, residual_, direction_;
  std::vector<Eigen::Vector3f> velocity_change_;  // of every node
};

}  // namespace oilskin::fluid
