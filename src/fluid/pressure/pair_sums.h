/// The pair loops of a step, chunk by chunk.
#pragma once

#include <algorithm>

#include "core/chunks.h"
#include "fluid/kernels.h"
#include "fluid/pressure/close_pairs.h"
#include "fluid/pressure/step_state.h"
#include "fluid/stability.h"
#include "oilskin/settings.h"

namespace oilskin::fluid {

constexpr std::size_t chunk_size = Neighbours::chunk_size;

inline Vec3 to_vector(const Record& r) {
  return {r.x, r.y, r.z};
}
inline Vec3 to_vector(const Change& c) {
  return {c.x, c.y, c.z};
}
inline Record to_record(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0};
}

/// The lists of the chunk that begins at particle `begin`.
inline PairTable pair_table(StepState& state, std::size_t begin) {
  const std::size_t chunk = begin / chunk_size;
  std::vector<float>& slopes = state.slope[chunk];
  return state.neighbours.table(chunk, slopes.empty() ? nullptr : slopes.data(),
                                state.mass_ratio.empty() ? nullptr : state.mass_ratio.data());
}

/// Memory for the slopes of a chunk, or none.
inline void provide_slopes(StepState& state, std::size_t chunk, std::size_t begin, std::size_t end) {
  bool stored = end <= state.most_with_slopes;
  for (std::size_t i = begin; i < end && !stored; ++i) stored = state.wall_point_of(i) != Boundary::none;
  const std::size_t pairs = stored ? state.neighbours.pair_capacity(chunk) : 0;
  std::vector<float>& slopes = state.slope[chunk];
  if (slopes.size() < pairs || !stored) std::vector<float>(pairs + pairs / 32).swap(slopes);
}

/// dv −= scale Σ_j (s_i + s_j) w'/q Δ for all particles. `x` are the positions with s in Record::w.
inline void apply_pressure(StepState& state, const std::vector<Record>& x, double scale) {
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    Change sum[chunk_size];
    pair_kernels().pressure_exact(pair_table(state, begin), x.data(), {begin, end}, sum);
    for (std::size_t i = begin; i < end; ++i) state.dv[i] -= scale * to_vector(sum[i - begin]);
  });
}

/// Adds λ_i of walls to the densities.
inline void add_wall_density(StepState& state) {
  for (const WallPoint& point : state.boundary.points())
    state.relative_density[point.particle] += point.lambda;
}

/// ρ/ρ0 = D (m_i w(0) + Σ m_j w) (F.5), m relative to a new particle, and XSPH [Schechter2012] (F.9) Δv = c Σ
/// V (v_j − v_i) W with c = 1 − exp(−rate dt), so that the smoothing per second does not depend on dt. V is
/// that of a new particle for all, weighted with m_j, so that the terms times m_i are antisymmetric. A pair
/// that approaches or leaves smooths faster (F.81).
struct ExplicitModel {
  float density_scale, self_density;
  PairFriction friction;
  double spacing, support_radius;  ///< dx, H [m]
  float close_square;              ///< of the distance of a close pair [H²] (F.86)
  float friction_load;  ///< half the largest eigenvalue of all friction at ρ0; it grows with ρ (F.84)

  ExplicitModel(const FluidSettings& s, double volume, double h, double dt)
      : density_scale(static_cast<float>(volume * CubicSpline::norm / std::pow(h, 3))),
        self_density(density_scale * static_cast<float>(CubicSpline::w(0.0))),
        spacing(s.spacing),
        support_radius(h),
        close_square(static_cast<float>(std::pow(closest_spacing * s.spacing / h, 2))) {
    const double smoothing = -std::expm1(-s.xsph_rate.value_or(0) * dt), most_by_strain = 0.125;
    friction.smoothing = static_cast<float>(smoothing) * density_scale;
    friction.by_strain = static_cast<float>(s.xsph_strain.value_or(0) * dt / s.spacing) * density_scale;
    friction.most_by_strain = static_cast<float>(most_by_strain) * density_scale;
    friction_load = static_cast<float>(viscous_load(s, dt) + 0.5 * smoothing +
                                       (friction.by_strain > 0 ? 0.5 * most_by_strain : 0));
  }
};

/// Whether velocities of pairs act at all.
inline bool has_friction(const FluidSettings& s) {
  return s.viscosity > 0 || s.xsph_rate.value_or(0) > 0 || s.xsph_strain.value_or(0) > 0;
}

/// The part of the friction that is stable at the largest density (F.84).
inline float stable_friction(const StepState& state, const ExplicitModel& model) {
  const Largest densest = state.ordered_sum(Largest{1}, [&](std::size_t begin, std::size_t end) {
    float part = 1;
    for (std::size_t i = begin; i < end; ++i) part = std::max(part, state.relative_density[i]);
    return Largest{static_cast<double>(part)};
  });
  return std::min(1.0f, 1 / (static_cast<float>(densest.value) * model.friction_load));
}

/// dv += scale · friction of all particles.
inline void add_friction(StepState& state, const ExplicitModel& model, double scale) {
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    float density[chunk_size];
    Change friction[chunk_size];
    pair_kernels().start(pair_table(state, begin), state.position().data(), state.velocity.data(),
                         model.friction, {begin, end}, {density, friction, nullptr, nullptr, 0});
    for (std::size_t i = begin; i < end; ++i) state.dv[i] += scale * to_vector(friction[i - begin]);
  });
}

/// Density, slopes and, `with_friction`, viscosity and XSPH of all particles. keep(rates, i) takes the rates
/// of particle i; nullptr: they are not asked for. Close pairs are parted.
template <class Keep>
void run_explicit_sums(StepState& state, const ExplicitModel& model, bool with_friction, const Keep& keep) {
  constexpr bool with_rates = !std::is_same_v<Keep, std::nullptr_t>;
  const std::size_t chunks = (state.size() + chunk_size - 1) / chunk_size;
  if (state.slope.size() < chunks) state.slope.resize(chunks);
  state.is_close.resize(state.size());
  state.workers.for_chunks(state.size(), chunk_size, [&](std::size_t begin, std::size_t end, std::size_t c) {
    provide_slopes(state, c, begin, end);
    float density[chunk_size];
    Change friction[chunk_size];
    PairRates rates[with_rates ? chunk_size : 1];
    pair_kernels().start(pair_table(state, begin), state.position().data(), state.velocity.data(),
                         model.friction, {begin, end},
                         {density, with_friction ? friction : nullptr, with_rates ? rates : nullptr,
                          &state.is_close[begin], model.close_square});
    for (std::size_t i = begin, k = 0; i < end; ++i, ++k) {
      const float own_mass = state.mass_ratio.empty() ? 1 : state.mass_ratio[i];
      state.relative_density[i] = own_mass * model.self_density + model.density_scale * density[k];
      if (with_friction) state.dv[i] += to_vector(friction[k]);
      if constexpr (with_rates) keep(rates[k], i);
    }
  });
  part_close_pairs(state, model.spacing, model.support_radius);
  // Densities are known only now. Clusters that are too dense for the friction are rare: it is summed again.
  if (!with_friction) return;
  const float stable = stable_friction(state, model);
  if (stable < 1) add_friction(state, model, static_cast<double>(stable) - 1);
}

}  // namespace oilskin::fluid
