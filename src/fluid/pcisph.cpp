/// Predictive–corrective incompressible SPH [Solenthaler, Pajarola 2009] with the cubic spline.
///
/// Pressures are kept as φ = p dt² V c/(ρ0 H²), without dimension, so that a pair pushes particle i by
/// −(φ_i + φ_j) w'/q Δ in units of H within the step.
#include <cmath>

#include "fluid/lattice.h"
#include "fluid/pair_sums.h"
#include "fluid/pressure_model.h"

namespace oilskin::fluid {

namespace {

using Kernel = CubicSpline;

/// A start that is compressed by more than this is not asked to be incompressible at the end of the step:
/// within one dt that means speeds of dx/dt, an explosion. The excess decays with the time constant instead.
constexpr float tolerated_compression = 0.05f;
constexpr double recovery_time = 0.002;  // [s]

struct PcisphModel : DensityModel<Kernel> {
  using Gradient = Kernel;
  float viscous;  // 2 (d+2) ν dt V c/H², d = 3

  PcisphModel(double volume, double support_radius, double smoothed_fraction, double viscosity_dt)
      : DensityModel(volume, support_radius, smoothed_fraction),
        viscous(static_cast<float>(10 * viscosity_dt * volume * Kernel::norm / std::pow(support_radius, 5))) {
  }

  /// Monaghan 2005: a_i = ν 2(d+2) Σ V (v_ij·x_ij)/(|x_ij|² + 0.01 H²) ∇W; conserves angular momentum too.
  Shear shear(const Pairs& pairs, F4 dv_dot_delta, F4, F4 slope, F4 w) const {
    return {F4(viscous) * dv_dot_delta / (pairs.q2 + F4(0.01f)) * slope, F4(smoothing) * w};
  }
};

/// Compression only: a signed mean would let the deficient free surface hide it, and spray would thin it out.
struct Errors {
  double sum = 0, largest = 0;  // of ρ*/ρ0 − 1
  double above_target = 0;      // sum of what the step does not tolerate
  std::uint64_t counted = 0;

  void add(double error, double target, double tolerance) {
    if (error <= -tolerance) return;
    sum += std::max(error, 0.0);
    above_target += error < target ? 0 : error - target;  // lets NaN through
    largest = std::max(largest, error);
    ++counted;
  }
  void operator+=(const Errors& o) {
    sum += o.sum;
    above_target += o.above_target;
    largest = std::max(largest, o.largest);
    counted += o.counted;
  }
  double mean(double total) const { return counted > 0 ? total / static_cast<double>(counted) : 0; }
};

class Pcisph : public PressureModel {
 public:
  explicit Pcisph(const FluidSettings& settings);

  double particle_volume() const override { return volume_; }

  void explicit_terms(StepState& state) const override {
    const double smoothed = -std::expm1(-settings_.xsph_rate * state.dt);
    run_explicit_sums(state, PcisphModel(volume_, support_radius_, smoothed, settings_.viscosity * state.dt),
                      settings_.viscosity > 0 || settings_.xsph_rate > 0);
  }

  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;

 private:
  void warm_start(StepState& state, const std::vector<double>& pressure, double phi_per_pascal);
  void predict(StepState& state);
  void keep_side(const StepState& state, Span<const PredictionContact> contacts, Vec3& displacement) const;
  Errors correct(StepState& state);
  void iterate(StepState& state, FluidReport& report);
  bool diverges(double mean);
  void relax(StepState& state, FluidReport& report, bool restart);

  const FluidSettings settings_;
  const double support_radius_, volume_;
  float density_scale_ = 0, self_density_ = 0;
  double stiffness_ = 0;       // δ for φ against ρ*/ρ0 − 1
  double relaxation_ = 1;      // ω
  double last_mean_ = 0;       // of the previous iteration
  int growing_ = 0;            // iterations in a row
  std::vector<Vec3> drift_;    // displacement without pressure, in units of H
  std::vector<float> target_;  // ρ*/ρ0 − 1 that the step aims at, 0 but for over-compressed particles
  std::vector<Record> predicted_;
};

/// δ and ω belong to the lattice on which particles of volume V pack: its spacing is V^(1/3) (a lattice that
/// is 8 % wider gives a δ 1.4 times too large, and the loop diverges).
Pcisph::Pcisph(const FluidSettings& s)
    : settings_(s),
      support_radius_(s.support_ratio * s.spacing),
      volume_(std::pow(s.spacing, 3) / lattice_density<Kernel>(s.support_ratio)) {
  const double packing = std::cbrt(volume_), ratio = support_radius_ / packing;
  const double scale = volume_ * Kernel::norm / std::pow(support_radius_, 3);
  density_scale_ = static_cast<float>(scale);
  self_density_ = density_scale_ * static_cast<float>(Kernel::w(0.0));
  stiffness_ = scale * pcisph_stiffness<Kernel>(ratio) / (ratio * ratio);
  relaxation_ = pcisph_relaxation<Kernel>(ratio);
}

void Pcisph::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  const double phi_per_pascal = state.dt * state.dt * static_cast<double>(density_scale_) /
                                (settings_.rest_density * support_radius_ * support_radius_);
  const float remaining = static_cast<float>(std::exp(-state.dt / recovery_time));
  drift_.resize(state.size());
  target_.resize(state.size());
  predicted_.resize(state.size() + 1);
  predicted_[state.size()] = state.position()[state.size()];  // the padding
  state.for_each([&](std::size_t i) {
    const Record& v = state.velocity[i];
    drift_[i] = (Vec3(v.x, v.y, v.z) + state.dv[i]) * (state.dt / support_radius_);
    target_[i] = remaining * std::max(0.0f, state.relative_density[i] - 1 - tolerated_compression);
  });
  warm_start(state, pressure, phi_per_pascal);
  iterate(state, report);
  apply_pressure(state, support_radius_ / state.dt);
  state.for_each(
      [&](std::size_t i) { pressure[i] = static_cast<double>(state.position()[i].w) / phi_per_pascal; });
}

/// p = ½ p_old (dt_old/dt)², so that the displacement by pressure starts at half of what it was.
void Pcisph::warm_start(StepState& state, const std::vector<double>& pressure, double phi_per_pascal) {
  const double ratio = state.previous_dt / state.dt, factor = 0.5 * ratio * ratio * phi_per_pascal;
  state.for_each([&](std::size_t i) { state.position()[i].w = static_cast<float>(factor * pressure[i]); });
}

void Pcisph::iterate(StepState& state, FluidReport& report) {
  last_mean_ = 0;
  growing_ = 0;
  for (int iteration = 1;; ++iteration) {
    predict(state);
    const Errors errors = correct(state);
    const double mean = errors.mean(errors.above_target);
    report.iterations = iteration;
    report.density_error_mean = errors.mean(errors.sum);
    report.density_error_max = errors.largest;
    report.converged = mean <= settings_.tolerance;
    if (report.converged && iteration >= settings_.min_iterations) return;
    if (!std::isfinite(mean))
      relax(state, report, true);
    else if (diverges(mean))
      relax(state, report, false);
    if (iteration >= settings_.max_iterations) return;
  }
}

/// x* = x + dt (v + dt a), with the pressures of now.
void Pcisph::predict(StepState& state) {
  state.workers.for_chunks(
      state.size(), Neighbours::chunk_size, [&](std::size_t begin, std::size_t end, std::size_t) {
        const PredictionContact* contact =
            std::lower_bound(state.contacts.begin(), state.contacts.end(), begin,
                             [](const PredictionContact& c, std::size_t i) { return c.particle < i; });
        for (std::size_t i = begin; i < end; ++i) {
          Vec3 d = drift_[i] - pressure_sum<F4>(state, i);
          const PredictionContact* first = contact;
          while (contact != state.contacts.end() && contact->particle == i) ++contact;
          if (contact != first) keep_side(state, {first, static_cast<std::size_t>(contact - first)}, d);
          const Record& x = state.position()[i];
          predicted_[i] = {x.x + static_cast<float>(d[0]), x.y + static_cast<float>(d[1]),
                           x.z + static_cast<float>(d[2]), 0};
        }
      });
}

/// Removes what approaches a sheet beyond the bound, one contact after the other; twice, since the later may
/// undo the earlier in a corner.
void Pcisph::keep_side(const StepState& state, Span<const PredictionContact> contacts,
                       Vec3& displacement) const {
  const double to_displacement = state.dt / support_radius_;
  for (int pass = 0; pass < (contacts.size() > 1 ? 2 : 1); ++pass)
    for (const PredictionContact& c : contacts) {
      const double short_of = c.least_normal_velocity * to_displacement - displacement.dot(c.normal);
      if (short_of > 0) displacement += short_of * c.normal;
    }
}

/// p ← max(0, p + ω δ (ρ* − ρ0)) at the predicted positions; the clamp belongs inside the loop, or free
/// surfaces contract.
Errors Pcisph::correct(StepState& state) {
  const float step = static_cast<float>(relaxation_ * stiffness_);
  return state.workers.ordered_sum(
      state.size(), Neighbours::chunk_size, Errors{}, [&](std::size_t b, std::size_t e) {
        Errors errors;
        for (std::size_t i = b; i < e; ++i) {
          const float density =
              self_density_ + density_scale_ * density_sum<Kernel>(state.neighbours, predicted_, i);
          float& phi = state.position()[i].w;
          // |S|² of the modes (lattice.h) grows with the square of the number density: so must ω δ shrink.
          const float compressed = std::max(1.0f, state.relative_density[i]);
          phi = std::max(0.0f, phi + step / (compressed * compressed) * (density - 1 - target_[i]));
          errors.add(static_cast<double>(density) - 1, static_cast<double>(target_[i]), settings_.tolerance);
        }
        return errors;
      });
}

bool Pcisph::diverges(double mean) {
  const bool far_above = mean > 10 * settings_.tolerance + 1e-3;
  growing_ = far_above && last_mean_ > 0 && mean > last_mean_ ? growing_ + 1 : 0;
  last_mean_ = mean;
  return growing_ >= 3;
}

/// Halves ω for this step and the coming ones.
void Pcisph::relax(StepState& state, FluidReport& report, bool restart) {
  report.diverged = true;
  relaxation_ = std::max(relaxation_ / 2, 1.0 / 256);
  growing_ = 0;
  last_mean_ = 0;
  if (restart) state.for_each([&](std::size_t i) { state.position()[i].w = 0; });
}

}  // namespace

std::unique_ptr<PressureModel> make_pcisph(const FluidSettings& settings) {
  return std::make_unique<Pcisph>(settings);
}

}  // namespace oilskin::fluid
