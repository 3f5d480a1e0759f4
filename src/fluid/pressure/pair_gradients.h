/// The gradients w'/q Δ of the pairs at the start of a step, three floats per pair, and sums with them.
#pragma once

#include "fluid/pressure/incompressible.h"

namespace oilskin::fluid {

/// Stores the gradients of four pairs in a row: four x, four y, four z.
inline void store_gradients(float* at, const Pairs& pairs, F4 slope) {
  store(at, slope * pairs.dx);
  store(at + 4, slope * pairs.dy);
  store(at + 8, slope * pairs.dz);
}

/// Sums over the pairs of a particle from which its α follows.
struct GradientRates {
  F4 gx, gy, gz, squares;

  /// `weighted`: slope times the mass of the neighbour.
  void add(const Pairs& pairs, F4 slope, F4 weighted, F4) {
    gx += weighted * pairs.dx;
    gy += weighted * pairs.dy;
    gz += weighted * pairs.dz;
    squares += weighted * slope * pairs.q2;
  }
  Record sum(float own_mass) const { return {total(gx), total(gy), total(gz), own_mass * total(squares)}; }
};

inline const float* gradients(const StepState& state, std::size_t i) {
  return state.slope[i / Neighbours::chunk_size].data() + 3 * state.neighbours.pair_begin(i);
}

/// −Σ_j m_j (φ_i + φ_j) w'/q Δ [H]. `Sum` is F4 inside iterations and Sum4 (double) for what is applied.
template <class Sum, bool weighted>
Vec3 pair_displacement(const StepState& state, const std::vector<float>& phi, std::size_t i) {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* gradient = gradients(state, i);
  const F4 own(phi[i]);
  Sum sx, sy, sz;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, gradient += 12) {
    const F4 both = own + gather(phi.data(), j);
    add_times_mass<weighted>(state, sx, both * load(gradient), j);
    add_times_mass<weighted>(state, sy, both * load(gradient + 4), j);
    add_times_mass<weighted>(state, sz, both * load(gradient + 8), j);
  }
  return -total(sx, sy, sz);
}

/// Σ_j m_j w'/q Δ·(y_i − y_j): the compression by displacements y [H], over D (F.29).
template <bool weighted>
float pair_compression(const StepState& state, const std::vector<Record>& y, std::size_t i) {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* gradient = gradients(state, i);
  const Record& u = y[i];
  F4 sum;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, gradient += 12) {
    const Record4 v(y.data(), j);
    const F4 rate = (F4(u.x) - v.x) * load(gradient) + (F4(u.y) - v.y) * load(gradient + 4) +
                    (F4(u.z) - v.z) * load(gradient + 8);
    add_times_mass<weighted>(state, sum, rate, j);
  }
  return total(sum);
}

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

inline Record to_record(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0};
}

}  // namespace oilskin::fluid
