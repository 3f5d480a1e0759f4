#include "fluid/pressure/incompressible.h"

#include "core/assert.h"
#include "fluid/stability.h"

namespace oilskin::fluid {

namespace {

using Kernel = CubicSpline;

/// s1 and the time constant of (F.18). A start that is compressed by more overlaps: no impact does that.
constexpr float overlap = 1;
constexpr double overlap_time = 0.002;  // [s]

/// How a step corrects the compression that it starts with (F.18). Velocities correct it, and a velocity is
/// kept: what is corrected within t adds speeds of (excess × depth)/t. A fast correction of what an impact
/// compressed made energies of several times the fall.
struct Correction {
  float tolerated;       ///< s0: excess beyond it decays, excess below it is corrected within `linear_time`
  double recovery_time;  ///< t_r [s]
  double linear_time;    ///< t_c [s]: a limit, else steps of a millionth of the length would explode
};

/// With boundary terms walls push what a correction moves, and contact does not stop it. With corrected
/// gradients shear changes the density (F.5) though no volume changes; to remove that at once makes energy.
Correction correction(const StepState& state, const FluidSettings& s) {
  const double g = state.gravity.norm();
  const double metres = s.spacing / metre(g);
  const double recovery = recovery_time(s.spacing, g);
  if (state.boundary.empty()) return {0.05f, recovery, 0.04 * metres};
  const bool is_corrected = s.solver == PressureSolver::dfsph && s.gradient_correction > 0;
  return {0.02f, recovery, is_corrected ? recovery / 2 : 0.2 * metres};
}

/// V_s/V (F.6): volume of a particle in settled water, which is disordered, over its volume on the lattice at
/// the same density. Measured as the height of columns of 20 layers, 14 particles across. (At H = 2 dx
/// columns 10 across are 0.4 % lower, wide basins 0.2 % higher, since the layers at walls pack more closely:
/// these are means. Far from walls it is 0.9976, about that of the closest packing of spheres, 0.9975.)
struct Settled {
  double ratio, volume;
};
constexpr Settled settled[] = {{1.5, 1.062}, {1.6, 1.027}, {1.8, 1.001},
                               {2, 0.994},   {2.2, 0.989}, {2.5, 0.978}};

double settled_volume_ratio(double ratio) {
  if (ratio <= settled[0].ratio) return settled[0].volume;
  for (std::size_t k = 1; k < std::size(settled); ++k) {
    const Settled &a = settled[k - 1], &b = settled[k];
    if (ratio < b.ratio) return a.volume + (b.volume - a.volume) * (ratio - a.ratio) / (b.ratio - a.ratio);
  }
  return std::end(settled)[-1].volume;
}

}  // namespace

/// τ and ω belong to the lattice on which particles of volume V pack: its spacing is V^(1/3). A lattice that
/// is 8 % wider gives a τ that is 1.4 times too large, and the loop diverges.
IncompressibleFluid::IncompressibleFluid(const FluidSettings& s)
    : settings(s),
      support_radius(s.support_ratio * s.spacing),
      volume(std::pow(s.spacing, 3) / lattice_density<Kernel>(s.support_ratio)),
      settled_volume(settled_volume_ratio(s.support_ratio) * volume),
      viscous_weights(fluid::viscous_weights<Kernel>(s.support_ratio)) {
  const double packing = std::cbrt(volume), ratio = support_radius / packing;
  const double scale = volume * Kernel::norm / std::pow(support_radius, 3);
  density_scale = static_cast<float>(scale);
  self_density = density_scale * static_cast<float>(Kernel::w(0.0));
  stiffness = scale * pcisph_stiffness<Kernel>(ratio) / (ratio * ratio);
  max_relaxation = pcisph_relaxation<Kernel>(ratio);
  wall_scale = 1 / density_scale;
  virial = settled_virial<Kernel>(s.support_ratio);
  OILSKIN_ASSERT(volume > 0 && stiffness > 0 && max_relaxation > 0 && max_relaxation <= 1);
}

ExplicitModel IncompressibleFluid::explicit_model(double dt) const {
  ExplicitModel model(settings, volume, support_radius, dt);
  const double scale = 2 * viscous_step(settings, dt) / (support_radius * support_radius);
  model.friction.by_slope = static_cast<float>(scale * viscous_weights.slope);
  model.friction.by_hat = static_cast<float>(scale * viscous_weights.hat);
  return model;
}

double IncompressibleFluid::phi_per_pascal(double dt) const {
  const double forces_over_masses = volume / (settled_volume * virial);
  return forces_over_masses * dt * dt * static_cast<double>(density_scale) /
         (settings.rest_density * support_radius * support_radius);
}

/// The displacement by pressure starts at a part w of that of the last step. A mode whose pressure is found
/// only in part falls behind its compression by w/(1 − w) steps, and such a spring makes energy. The damping,
/// which is the part of the pressure that follows the rate of compression, takes it where 1 − w > dt/t_c
/// (F.82). After a longer step the pressure is kept, not the displacement: within a millionth of the time
/// that would accelerate the water.
double IncompressibleFluid::warm_start(const StepState& state) const {
  OILSKIN_ASSERT(state.previous_dt >= 0 && state.dt > 0);
  const double kept = 1 - 1.25 * state.dt / correction(state, settings).linear_time;
  const double ratio = std::min(1.0, state.previous_dt / state.dt);
  return std::min(std::max(kept, 0.5), 0.95) * ratio * ratio * phi_per_pascal(state.dt);
}

/// What a loop leaves in each step gathers until its correction within t_c is as large. So the error of the
/// density at rest is this part of the tolerance times t_c/dt.
double IncompressibleFluid::error_per_step(const StepState& state) const {
  return settings.tolerance * std::min(1.0, 2 * state.dt / correction(state, settings).linear_time);
}

CorrectionEnergy IncompressibleFluid::energy_of_correction(const StepState& state) const {
  const double recovery_time = correction(state, settings).recovery_time, dx = 1 / settings.support_ratio;
  const double slow = 0.1 * dx * state.dt / recovery_time;
  CorrectionEnergy energy;
  energy.of_all = slow * slow * state.dt / recovery_time;
  energy.of_overlap = dx * -std::expm1(-state.dt / overlap_time);
  return energy;
}

double CorrectionEnergy::of(double relative_density) const {
  const double d = of_overlap * std::max(0.0, relative_density - 1 - static_cast<double>(overlap));
  return of_all + d * d;
}

void set_targets(const StepState& state, const FluidSettings& settings, std::vector<float>& target) {
  OILSKIN_ASSERT(state.relative_density.size() == state.size());
  const Correction c = correction(state, settings);
  const float of_overlap = static_cast<float>(std::exp(-state.dt / overlap_time));
  const float of_excess = static_cast<float>(std::exp(-state.dt / c.recovery_time));
  const float of_tolerated = static_cast<float>(std::max(0.0, 1 - state.dt / c.linear_time));
  target.resize(state.size());
  state.for_each([&](std::size_t i) {
    const float excess = std::max(0.0f, state.relative_density[i] - 1);
    target[i] = of_overlap * std::max(0.0f, excess - overlap) +
                of_excess * std::max(0.0f, std::min(excess, overlap) - c.tolerated) +
                of_tolerated * std::min(excess, c.tolerated);
  });
}

}  // namespace oilskin::fluid
