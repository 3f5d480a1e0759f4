/// The loops over pairs. Lengths are in units of H: Δ = (x_i − x_j)/H, q = |Δ|.
///
/// Both sides compute a pair term by the same float operations on the same numbers (differences change sign
/// exactly, everything else commutes), so that f_ij = −f_ji bit for bit. Terms that change velocities are
/// summed in double: the momentum of the fluid is conserved to 1e-16 per particle.
#pragma once

#include "fluid/kernels.h"
#include "fluid/pressure/step_state.h"

namespace oilskin::fluid {

/// Four pairs of particle i.
struct Pairs {
  F4 dx, dy, dz, q2;
  Pairs(const Record& i, const Record4& j)
      : dx(F4(i.x) - j.x), dy(F4(i.y) - j.y), dz(F4(i.z) - j.z), q2(dx * dx + dy * dy + dz * dz) {}
};

inline Vec3 total(F4 x, F4 y, F4 z) {
  return {total(x), total(y), total(z)};
}
inline Vec3 total(const Sum4& x, const Sum4& y, const Sum4& z) {
  return {x.total(), y.total(), z.total()};
}

/// a weighted with the masses of the neighbours `j`, where masses differ: a type for that, `weighted`.
template <bool weighted>
F4 times_mass(const StepState& state, F4 a, const std::uint32_t* j) {
  if constexpr (weighted) return a * gather(state.mass_ratio.data(), j);
  return a;
}

/// sum += a, weighted. The product is exact: m_i times what j does to i is minus m_j times the reverse.
template <bool weighted>
void add_times_mass(const StepState& state, Sum4& sum, F4 a, const std::uint32_t* j) {
  if constexpr (weighted)
    sum.add_product(a, gather(state.mass_ratio.data(), j));
  else
    sum += a;
}
template <bool weighted>
void add_times_mass(const StepState& state, F4& sum, F4 a, const std::uint32_t* j) {
  sum += times_mass<weighted>(state, a, j);
}

/// Σ_j m_j w(q_ij) over the neighbours, without i itself, at the positions `x`.
template <class Kernel, bool weighted>
float density_sum(const StepState& state, const std::vector<Record>& x, std::size_t i) {
  const std::uint32_t* j = state.neighbours.list(i);
  F4 sum;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4) {
    const Pairs pairs(x[i], Record4(x.data(), j));
    add_times_mass<weighted>(state, sum, Kernel::w(root(pairs.q2)), j);
  }
  return total(sum);
}

/// Σ_j m_j (s_i + s_j) w'(q_ij)/q_ij Δ_ij: the pressure gradient. `x` are the positions with s in Record::w,
/// so that one load per neighbour has both. `Sum` is F4 inside iterations and Sum4 (double) for what is
/// applied.
template <class Sum, bool weighted>
Vec3 pressure_sum(const StepState& state, const std::vector<Record>& x, std::size_t i) {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* slope = state.slopes(i);
  const F4 own(x[i].w);
  Sum sx, sy, sz;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, slope += 4) {
    const Record4 other(x.data(), j);
    const Pairs pairs(x[i], other);
    const F4 f = (own + other.w) * load(slope);
    add_times_mass<weighted>(state, sx, f * pairs.dx, j);
    add_times_mass<weighted>(state, sy, f * pairs.dy, j);
    add_times_mass<weighted>(state, sz, f * pairs.dz, j);
  }
  return total(sx, sy, sz);
}

/// dv −= scale Σ_j (s_i + s_j) w'/q Δ for all particles.
inline void apply_pressure(StepState& state, const std::vector<Record>& x, double scale) {
  state.by_masses([&](auto weighted) {
    state.for_each([&](std::size_t i) { state.dv[i] -= scale * pressure_sum<Sum4, weighted>(state, x, i); });
  });
}

/// Density, slopes and, `with_velocity`, viscosity and XSPH of particle i. Model::Density and Model::Gradient
/// are kernels; model.shear(pairs, dv·Δ, q, slope, w) returns {a, b} of the pair term a Δ − b (v_i − v_j).
/// Model::Rates are further sums, which model.keep(rates, m_i, i) stores. Model::store_pair writes `per_pair`
/// floats per pair.
template <bool with_velocity, bool weighted, class Model>
void explicit_sums(StepState& state, const Model& model, std::size_t i) {
  const std::vector<Record>& x = state.position();
  const std::vector<Record>& v = state.velocity;
  const std::uint32_t* j = state.neighbours.list(i);
  constexpr std::size_t per_pair = Model::per_pair;
  float* slope = state.slope[i / Neighbours::chunk_size].data() + per_pair * state.neighbours.pair_begin(i);
  F4 density;
  Sum4 sx, sy, sz;
  typename Model::Rates rates;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, slope += 4 * per_pair) {
    const Pairs pairs(x[i], Record4(x.data(), j));
    const F4 q = root(pairs.q2), w = Model::Density::w(q), g = Model::Gradient::dw_over_q(q);
    Model::store_pair(slope, pairs, g);
    add_times_mass<weighted>(state, density, w, j);
    if constexpr (with_velocity) {
      const Record4 u(v.data(), j);
      const F4 vx = F4(v[i].x) - u.x, vy = F4(v[i].y) - u.y, vz = F4(v[i].z) - u.z;
      const F4 dv_dot_delta = vx * pairs.dx + vy * pairs.dy + vz * pairs.dz;
      rates.add(pairs, g, times_mass<weighted>(state, g, j), dv_dot_delta);
      const auto [along, against] = model.shear(pairs, dv_dot_delta, q, g, w);
      add_times_mass<weighted>(state, sx, along * pairs.dx - against * vx, j);
      add_times_mass<weighted>(state, sy, along * pairs.dy - against * vy, j);
      add_times_mass<weighted>(state, sz, along * pairs.dz - against * vz, j);
    }
  }
  const float own_mass = weighted ? state.mass_ratio[i] : 1;
  state.relative_density[i] = own_mass * model.self_density + model.density_scale * total(density);
  if constexpr (with_velocity) {
    state.dv[i] += total(sx, sy, sz);
    model.keep(rates, own_mass, i);
  }
}

/// Adds λ_i of walls to the densities.
inline void add_wall_density(StepState& state) {
  for (const WallPoint& point : state.boundary.points())
    state.relative_density[point.particle] += point.lambda;
}

struct Shear {
  F4 along, against;
};

struct NoRates {
  void add(const Pairs&, F4, F4, F4) {}
};

/// Base of the models: ρ/ρ0 = D (m_i w(0) + Σ m_j w) (F.5), m relative to a new particle, and XSPH
/// [Schechter2012] (F.9) Δv = c Σ V (v_j − v_i) W with c = 1 − exp(−rate dt), so that the smoothing per
/// second does not depend on dt. V is that of a new particle for all, weighted with m_j, so that the terms
/// times m_i are antisymmetric.
template <class Kernel>
struct DensityModel {
  using Density = Kernel;
  using Rates = NoRates;
  static constexpr std::size_t per_pair = 1;
  float density_scale, self_density, smoothing;

  DensityModel(double volume, double support_radius, double smoothed_fraction)
      : density_scale(static_cast<float>(volume * Kernel::norm / std::pow(support_radius, 3))),
        self_density(density_scale * static_cast<float>(Kernel::w(0.0))),
        smoothing(static_cast<float>(smoothed_fraction) * density_scale) {}

  static void store_pair(float* out, const Pairs&, F4 slope) { store(out, slope); }
  void keep(const NoRates&, float, std::size_t) const {}
};

template <class Model>
void run_explicit_sums(StepState& state, const Model& model, bool with_velocity) {
  const std::size_t chunk = Neighbours::chunk_size, chunks = (state.size() + chunk - 1) / chunk;
  if (state.slope.size() < chunks) state.slope.resize(chunks);
  state.workers.for_chunks(state.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    const std::size_t pairs = Model::per_pair * state.neighbours.pair_capacity(c);
    if (state.slope[c].size() < pairs) state.slope[c].resize(pairs + pairs / 4);
    state.by_masses([&](auto weighted) {
      for (std::size_t i = begin; i < end; ++i)
        with_velocity ? explicit_sums<true, weighted>(state, model, i)
                      : explicit_sums<false, weighted>(state, model, i);
    });
  });
}

}  // namespace oilskin::fluid
