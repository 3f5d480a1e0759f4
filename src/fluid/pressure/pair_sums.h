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

/// Σ_j w(q_ij) over the neighbours, without i itself, at the positions `x`.
template <class Kernel>
float density_sum(const Neighbours& neighbours, const std::vector<Record>& x, std::size_t i) {
  const std::uint32_t* j = neighbours.list(i);
  F4 sum;
  for (std::uint32_t b = neighbours.blocks(i); b > 0; --b, j += 4) {
    const Pairs pairs(x[i], Record4(x.data(), j));
    sum += Kernel::w(root(pairs.q2));
  }
  return total(sum);
}

/// Σ_j (s_i + s_j) w'(q_ij)/q_ij Δ_ij: the pressure gradient. `x` are the positions with s in Record::w, so
/// that one load per neighbour has both. `Sum` is F4 inside iterations and Sum4 (double) for what is applied.
template <class Sum>
Vec3 pressure_sum(const StepState& state, const std::vector<Record>& x, std::size_t i) {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* slope = state.slopes(i);
  const F4 own(x[i].w);
  Sum sx, sy, sz;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, slope += 4) {
    const Record4 other(x.data(), j);
    const Pairs pairs(x[i], other);
    const F4 f = (own + other.w) * load(slope);
    sx += f * pairs.dx;
    sy += f * pairs.dy;
    sz += f * pairs.dz;
  }
  return total(sx, sy, sz);
}

/// dv −= scale Σ_j (s_i + s_j) w'/q Δ for all particles.
inline void apply_pressure(StepState& state, const std::vector<Record>& x, double scale) {
  state.for_each([&](std::size_t i) { state.dv[i] -= scale * pressure_sum<Sum4>(state, x, i); });
}

/// Density, slopes and, `with_velocity`, viscosity and XSPH of particle i. Model::Density and Model::Gradient
/// are kernels; model.shear(pairs, dv·Δ, q, slope, w) returns {a, b} of the pair term a Δ − b (v_i − v_j).
/// Model::Rates are further sums, which model.keep(rates, i) stores. Model::store_pair writes `per_pair`
/// floats per pair.
template <bool with_velocity, class Model>
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
    density += w;
    if constexpr (with_velocity) {
      const Record4 u(v.data(), j);
      const F4 vx = F4(v[i].x) - u.x, vy = F4(v[i].y) - u.y, vz = F4(v[i].z) - u.z;
      const F4 dv_dot_delta = vx * pairs.dx + vy * pairs.dy + vz * pairs.dz;
      rates.add(pairs, g, dv_dot_delta);
      const auto [along, against] = model.shear(pairs, dv_dot_delta, q, g, w);
      sx += along * pairs.dx - against * vx;
      sy += along * pairs.dy - against * vy;
      sz += along * pairs.dz - against * vz;
    }
  }
  state.relative_density[i] = model.self_density + model.density_scale * total(density);
  if constexpr (with_velocity) {
    state.dv[i] += total(sx, sy, sz);
    model.keep(rates, i);
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
  void add(const Pairs&, F4, F4) {}
};

/// Base of the models: ρ/ρ0 = D (w(0) + Σ w) (F.5), and XSPH [Schechter2012] (F.9) Δv = c Σ V (v_j − v_i) W
/// with c = 1 − exp(−rate dt), so that the smoothing per second does not depend on dt. V is the same for all
/// particles, so that the terms are antisymmetric.
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
  void keep(const NoRates&, std::size_t) const {}
};

template <class Model>
void run_explicit_sums(StepState& state, const Model& model, bool with_velocity) {
  const std::size_t chunk = Neighbours::chunk_size, chunks = (state.size() + chunk - 1) / chunk;
  if (state.slope.size() < chunks) state.slope.resize(chunks);
  state.workers.for_chunks(state.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    const std::size_t pairs = Model::per_pair * state.neighbours.pair_capacity(c);
    if (state.slope[c].size() < pairs) state.slope[c].resize(pairs + pairs / 4);
    for (std::size_t i = begin; i < end; ++i)
      with_velocity ? explicit_sums<true>(state, model, i) : explicit_sums<false>(state, model, i);
  });
}

}  // namespace oilskin::fluid
