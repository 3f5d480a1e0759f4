/// The linear system of implicit viscosity, (V.3), without a matrix: its pairs, walls and nodes.
#pragma once

#include <optional>
#include <vector>

#include "effects/viscosity/particle_memory.h"
#include "effects/viscosity/support_memory.h"
#include "effects/viscosity/wall_drag.h"
#include "oilskin/effect.h"

namespace oilskin::effects {

/// The unknowns are the velocities of the particles and, behind them, those of the free nodes and the changes
/// of velocity of the dynamic bodies that drag particles: two for a body, in the units of (V.11). Inner
/// products weigh each with its mass, in which the operator is symmetric and ≥ 1.
class ViscousSystem {
 public:
  using Vector = std::vector<Vec3>;

  /// Of one interval. `forces` must outlive the use of the system.
  void build(EffectForces& forces, double coefficient);

  std::size_t size() const { return weight_.size(); }
  /// v* and u* of (V.1), (V.7).
  const Vector& start() const { return start_; }
  /// (A − 1) x, the change by viscosity with the opposite sign; `walls_move`: with the velocity of prescribed
  /// nodes, which makes it affine; else as if they stood still.
  void drag(const Vector& x, Vector& result, bool walls_move) const;
  /// The diagonal blocks' inverse times x.
  void precondition(const Vector& x, Vector& result) const;
  /// Σ m x·y over m0, summed in fixed order.
  double dot(const Vector& x, const Vector& y) const;
  /// Norm of the velocities v* against each other and against the walls, which the tolerance refers to.
  double scale() const;
  /// The size of v* to which rounding is relative, in a residual.
  double rounding() const;
  /// Work over m0 that prescribed nodes do on the liquid, of the velocities x.
  double work_of_walls(const Vector& x) const;
  /// Pushes the surfaces with `share` of the reaction of the velocities x, whose drag() is `drag`.
  void react(const Vector& x, const Vector& drag, double share);

 private:
  static constexpr std::uint32_t none = UINT32_MAX;

  struct Pair {
    Vec3 s;  // (V.2)
    std::uint32_t other;
  };
  struct WallTerm {
    const VisibleWall* wall;
    double along, across;  // dt times the rates of (V.4)
    Vec3 base;             // velocity by prescribed nodes, and of the body [m/s]
    std::array<std::uint32_t, 3> node = {none, none, none};  // unknown, or none
    std::uint32_t body = none;                               // index into bodies_, or none
    Vec3 arm = Vec3::Zero();                                 // from its centre of mass [m]
  };

  struct FreeNode {
    std::size_t surface;
    std::uint32_t node;
    std::uint32_t unknown;
  };

  /// A dynamic body whose unknowns y, z change its velocity by linear y and its angular velocity by angular
  /// z.
  struct FreeBody {
    std::size_t surface;
    std::uint32_t unknown;  // of y; that of z follows
    RigidVelocity velocity;
    Vec3 linear;  // √(m/M) along the axes of the world
    Eigen::Matrix3d angular;

    Vec3 change_at(const Vec3& arm, const Vector& x) const {
      return linear.cwiseProduct(x[unknown]) + (angular * x[unknown + 1]).cross(arm);
    }
  };

  double ratio(std::size_t i) const { return forces_->mass_ratio.empty() ? 1 : forces_->mass_ratio[i]; }
  void find_pairs(double coefficient);
  void find_walls(double coefficient);
  void add_wall(const VisibleWall& wall, double coefficient);
  std::uint32_t unknown_of(std::size_t surface, std::uint32_t node);
  std::uint32_t body_of(std::size_t surface);
  void find_velocity(WallTerm& term);
  void find_diagonals();
  /// Velocity of particle i against the wall.
  Vec3 relative(const WallTerm& term, std::size_t i, const Vector& x, bool walls_move) const;
  /// What the wall takes off the velocity of particle i.
  Vec3 traction(const WallTerm& term, std::size_t i, const Vector& x, bool walls_move) const;

  EffectForces* forces_ = nullptr;
  std::optional<WallDrag> drag_;
  std::size_t particles_ = 0;
  std::vector<Pair> pairs_;
  std::vector<std::size_t> pair_begin_;
  std::vector<WallTerm> walls_;
  std::vector<std::size_t> wall_begin_;
  std::vector<std::vector<std::uint32_t>> node_unknown_;  // per surface and node
  std::vector<FreeNode> free_nodes_;
  std::vector<std::uint32_t> surface_body_;  // per surface: index into bodies_, or none
  std::vector<FreeBody> bodies_;
  std::vector<double> weight_;  // mass over m0
  Vector start_;
  std::vector<Eigen::Matrix3d> inverse_diagonal_;
  double largest_diagonal_ = 1;
  mutable std::vector<double> products_;
};

}  // namespace oilskin::effects
