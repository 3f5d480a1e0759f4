/// The flow of absorbed liquid between the nodes of a textile in one interval.
#pragma once

#include <vector>

#include "effects/wetting/sparse_solver.h"
#include "effects/wetting/wetting_mesh.h"

namespace oilskin {

/// The implicit step (W.9)–(W.12). Values per node and per edge are those of the mesh.
class WettingFlow {
 public:
  struct Interval {
    /// [s]
    double dt = 0;
    /// Of the nodes [m].
    Span<const Vec3> position;
    /// g/(9.81 m/s² ℓ_c) [1/m].
    Vec3 slope = Vec3::Zero();
    /// a
    double exponent = 0;
    /// Per node, S at the start.
    const std::vector<double>* saturation = nullptr;
    /// Per node: S that the flow may reach.
    const std::vector<double>* upper = nullptr;
    /// Per node: 1 where S does not change.
    const std::vector<std::uint8_t>* held = nullptr;
  };

  explicit WettingFlow(const WettingMesh& mesh) : mesh_(mesh) {}

  /// Solves with conductances that are not negative. False: no liquid can move, or the equations could not
  /// be solved (is_solved()).
  bool solve(const Interval& interval);
  /// Solves again with all conductances, after solve() was true. False: could not be solved; the values
  /// below are of no use.
  bool solve_with_negative_conductances();
  bool is_solved() const { return is_solved_; }

  /// Nodes that are wet or next to a wet one, ascending.
  const std::vector<std::uint32_t>& nodes() const { return nodes_; }
  /// What moved over each edge from its first node to the second, in all and by gravity [kg].
  const std::vector<double>& amount() const { return amount_; }
  const std::vector<double>& drift() const { return drift_amount_; }
  int iterations() const { return iterations_; }

 private:
  void find_nodes();
  void find_mobilities();
  void set_drift(std::uint32_t edge);
  void set_diffusion(bool with_negative);
  void assemble();
  std::uint32_t assemble_row(std::uint32_t row, std::uint32_t end);
  bool solve_rows(double accepted);
  bool fill();
  void find_amounts();
  void set_storage();

  const WettingMesh& mesh_;
  Interval in_;
  std::vector<std::uint32_t> nodes_, row_of_, edges_;
  std::vector<double> diffusive_, gravitational_;  // Sᵃ and S^max(a, 1) per node
  std::vector<double> diffusion_, drift_;          // coefficients per edge [kg]
  std::vector<double> amount_, drift_amount_;
  std::vector<std::uint8_t> is_full_;  // per row, as the following
  std::vector<double> storage_, offset_, potential_, right_, weight_;
  SparseMatrix matrix_;
  SparseSolver solver_;
  int iterations_ = 0;
  bool is_solved_ = true;
};

}  // namespace oilskin
