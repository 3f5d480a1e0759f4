/// [Mueller2003] with one kernel for density and pressure gradient, which have one energy then: cubic spline,
/// viscosity Laplacian, state equation.
#include <cmath>

#include "core/assert.h"
#include "fluid/lattice.h"
#include "fluid/pressure/pair_sums.h"
#include "fluid/pressure/pressure_model.h"
#include "fluid/stability.h"

namespace oilskin::fluid {

namespace {

class Mcg03 : public PressureModel {
 public:
  explicit Mcg03(const FluidSettings& s)
      : settings_(s),
        support_radius_(s.support_ratio * s.spacing),
        volume_(std::pow(s.spacing, 3) / lattice_density<CubicSpline>(s.support_ratio)) {}

  double particle_volume() const override { return volume_; }

  void explicit_terms(StepState& state) override {
    ExplicitModel model(settings_, volume_, support_radius_, state.dt);
    // (F.14), [Mueller2003] Eq. 14: f = μ Σ V (v_j − v_i) ∇²W, here with V = m/ρ0.
    model.friction.by_laplacian = static_cast<float>(viscous_step(settings_, state.dt) * volume_ *
                                                     ViscosityKernel::norm / std::pow(support_radius_, 5));
    run_explicit_sums(state, model, has_friction(settings_), nullptr);
  }

  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;

 private:
  const FluidSettings settings_;
  const double support_radius_, volume_;
  std::vector<Record> x_share_;  // positions, and what the pressure of a particle adds to its pair forces
};

/// p = k (ρ − ρ0), not below 0 (F.13): with tension particles at free surfaces clump. The pair force (F.14),
/// a_i = −Σ m (p_i/ρ_i² + p_j/ρ_j²) ∇W, is antisymmetric and needs one number per particle.
void Mcg03::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  OILSKIN_ASSERT(pressure.size() >= state.size() && state.relative_density.size() == state.size());
  const double rest_density = settings_.rest_density, mass = volume_ * rest_density;
  const double scale =
      state.dt * mass * CubicSpline::norm / std::pow(support_radius_, 4);  // of w'/q Δ in m ∇W dt
  // Sound must not travel farther than 0.4 H in a step, or the explicit integration adds energy: the fluid
  // becomes softer instead.
  const double fastest_sound = 0.4 * support_radius_ / state.dt;
  const double stiffness = std::min(settings_.stiffness, fastest_sound * fastest_sound);
  x_share_ = state.position();
  state.for_each([&](std::size_t i) {
    const double density = rest_density * static_cast<double>(state.relative_density[i]);
    OILSKIN_ASSERT(density > 0);  // w(0) at least
    pressure[i] = std::max(0.0, stiffness * (density - rest_density));
    x_share_[i].w = static_cast<float>(scale * pressure[i] / (density * density));
  });
  apply_pressure(state, x_share_, 1);

  std::uint64_t counted = 0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const double error = static_cast<double>(state.relative_density[i]) - 1;
    if (!(error > -settings_.tolerance)) continue;
    ++counted;
    report.density_error_mean += std::max(error, 0.0);
    report.density_error_max = std::max(report.density_error_max, error);
  }
  if (counted > 0) report.density_error_mean /= static_cast<double>(counted);
}

}  // namespace

std::unique_ptr<PressureModel> make_mcg03(const FluidSettings& settings) {
  return std::make_unique<Mcg03>(settings);
}

}  // namespace oilskin::fluid
