/// Iteration with a momentum term (F.34).
#pragma once

#include "fluid/boundary/boundary.h"
#include "fluid/pressure/incompressible.h"

namespace oilskin::fluid {

/// The ν-methods of [Hanke1991]: the residual after k corrections is the k-th ultraspherical polynomial in
/// place of the k-th power of Jacobi's iteration matrix, and a column of N layers takes in the order of N
/// corrections instead of N². From the second correction on the residual of no mode is below −1/6.
struct Momentum {
  static constexpr float order = 2.5;  // β of the ultraspherical polynomials
  float weight;

  /// `corrections` since the momentum was restarted.
  explicit Momentum(int corrections) {
    const float k = static_cast<float>(corrections);
    weight = 2 * (k + order) / (k + 2 * order);
  }
};

/// |γ|² of one plane half a spacing away at H = 2 dx.
constexpr float plane_gamma2 = 4;

/// The response of a corner of walls exceeds that of the lattice for which τ was made (B.22).
inline float step_at_walls(const IncompressibleFluid& fluid, const WallPoint& point, float step) {
  const float corner = std::max(0.0f, point.gamma.squaredNorm() - plane_gamma2);
  return step / (1 + step * fluid.wall_scale * corner);
}

}  // namespace oilskin::fluid
