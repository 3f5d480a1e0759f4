/// How the density of a particle responds to its pressure: α and τ of DFSPH.
#pragma once

#include "fluid/pressure/incompressible.h"

namespace oilskin::fluid {

/// 1/α (F.28), [Bender2015] Eq. 8 in our units: by how much the density of particle i falls per φ_i. The
/// image of a particle behind a wall has its pressure. `pull` = D Σ m_j w'/q Δ, `of_neighbours` = D Σ m_i m_j
/// |w'|².
inline float density_response(const IncompressibleFluid& fluid, const StepState& state, std::size_t i,
                              Eigen::Vector3f pull, float of_neighbours) {
  const std::uint32_t k = state.boundary.empty() ? Boundary::none : state.boundary.point_of(i);
  if (k != Boundary::none) pull -= state.boundary.points()[k].gamma;
  return of_neighbours + fluid.wall_scale * pull.squaredNorm();
}

/// Lower bound of 1/α relative to that of the lattice (F.30). Smaller values belong to isolated particles and
/// to particles that nearly coincide: no pressure separates the latter, and without the bound theirs reaches
/// 1e12 Pa and accelerates everything near them.
constexpr float min_response = 0.1f;

/// τ_i (F.30). Neighbours correct the same compression at the same time, so a step is half of α, as PCISPH's
/// τ is; where the fluid is compressed there are more of them.
inline float density_step(const IncompressibleFluid& fluid, float relative_density, float response) {
  const float compressed = std::max(1.0f, relative_density);
  const float minimum = min_response / static_cast<float>(2 * fluid.stiffness);
  return 0.5f / (std::max(response, minimum * compressed) * compressed);
}

}  // namespace oilskin::fluid
