/// The part of a pressure iteration that walls take: their motion under the pressures, their density at the
/// predicted positions, and the coupled correction of the particles at walls (docs/theory/boundary.md, 5 to
/// 9).
#pragma once

#include "fluid/pressure/incompressible.h"
#include "fluid/pressure/prediction_contact.h"

namespace oilskin::fluid {

/// The pressures φ of all particles, a field of their records.
struct Pressures {
  Pressures(const std::vector<Record>& x_phi) : records(x_phi.data()) {}  // NOLINT: a view
  float operator[](std::size_t i) const { return records[i].w; }

  const Record* records;
};

/// λ* of (B.17): linear in the displacements, or limited to 0 … 1. An iteration on first-order densities
/// needs the linear one: beyond a limit the push of a wall would have no effect that the density shows, and
/// grow.
enum class WallDensity { limited, linear };

class WallResponse {
 public:
  WallResponse(const IncompressibleFluid& fluid, WallDensity wall_density)
      : fluid_(fluid), wall_density_(wall_density) {}

  void begin_step(const StepState& state);

  /// Velocities of the walls under the pressures (B.18).
  void predict_walls(StepState& state, Pressures phi);

  /// `displacement` of particle i [H] without walls and contacts → with the force of its walls, on its side
  /// of the sheets that it is in contact with (F.36). Stores the density of its walls there (B.17).
  void constrain(const StepState& state, std::size_t i, float phi, Span<const PredictionContact> contacts,
                 Vec3& displacement) {
    const std::uint32_t point = state.wall_point_of(i);
    if (point != Boundary::none || !contacts.empty()) constrain_at(state, point, phi, contacts, displacement);
  }
  /// λ* of a point.
  float density(std::uint32_t point) const { return density_[point]; }

  /// The pressures of neighbouring particles at light walls are coupled through shared nodes, so that a
  /// Jacobi correction would diverge. Their residuals and steps τ are collected here (τ = 0 for a pressure
  /// that stays), and solve() returns the changes of φ per point (B.21).
  void collect(std::uint32_t point, float step, float residual) {
    step_[point] = step;
    change_[point] = residual;
  }
  const std::vector<float>& solve(StepState& state);

  /// Adds the pressures to dv and to the velocities of the walls.
  void apply(StepState& state, Pressures phi);

 private:
  void constrain_at(const StepState& state, std::uint32_t k, float phi,
                    Span<const PredictionContact> contacts, Vec3& displacement);
  template <class T>
  WallLoad<T> load_on_walls(const WallPoint& point, T phi) const;
  double rebound_limit(const StepState& state, std::size_t point, const WallLoad<double>& load) const;

  const IncompressibleFluid& fluid_;
  const WallDensity wall_density_;
  float phi_per_depth_ = 0;  // φ_g of (B.16): hydrostatic, per H of depth
  // Per point of the boundary
  std::vector<float> theta_;    // [m/s] (B.11)
  std::vector<float> depth_;    // θ′ of (B.16) [m/s]; where there are bodies
  std::vector<float> density_;  // λ*
  std::vector<float> step_, change_;
  std::vector<WallLoad<double>> load_;
};

}  // namespace oilskin::fluid
