/// Predictive–corrective incompressible SPH [Solenthaler2009] with the cubic spline. The loop finds the
/// pressures that keep the velocities of the step from compressing the fluid; what error the density has is
/// corrected by positions alone (density_shift.h).

#include "core/assert.h"
#include "fluid/pressure/contact_bounds.h"
#include "fluid/pressure/density_shift.h"
#include "fluid/pressure/image_pairs.h"
#include "fluid/pressure/momentum.h"
#include "fluid/pressure/pressure_loop.h"
#include "fluid/pressure/pressure_model.h"
#include "fluid/pressure/wall_response.h"

namespace oilskin::fluid {

namespace {

struct Sums : IncompressibleSums {
  using Rates = GradientRates;
  static constexpr std::size_t per_pair = 3;
  std::vector<Record>& gradient;

  Sums(const IncompressibleSums& sums, std::vector<Record>& g) : IncompressibleSums(sums), gradient(g) {}
  static void store_pair(float* at, const Pairs& pairs, F4 slope) { store_gradients(at, pairs, slope); }
  void keep(const Rates& r, std::size_t i) const { gradient[i] = r.sum(); }
};

class PcisphSplit : public PressureModel {
 public:
  explicit PcisphSplit(const FluidSettings& settings)
      : fluid_(settings),
        loop_(fluid_.max_relaxation, settings.max_iterations),
        walls_(fluid_, true),
        shift_(fluid_) {}

  double particle_volume() const override { return fluid_.settled_volume; }
  void explicit_terms(StepState& state) override;
  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;
  Memory memory() const override { return {loop_.relaxation(), 0, 0}; }
  void set_memory(const Memory& memory) noexcept override { loop_.set_relaxation(memory.relaxation); }
  void visit(Archive& archive) override { loop_.visit(archive); }

 private:
  void begin_step(StepState& state, const std::vector<double>& pressure);
  void restart_momentum(const StepState& state);
  void iterate(StepState& state);
  void predict_positions(StepState& state);
  float predicted_density(const StepState& state, std::size_t i) const;
  Errors correct(StepState& state);

  const IncompressibleFluid fluid_;
  PressureLoop loop_;
  WallResponse walls_;
  DensityShift shift_;
  std::vector<Vec3> drift_;    // displacement without pressure [H]
  std::vector<float> target_;  // ē_i
  std::vector<float> phi_;     // with one more for the padding
  std::vector<float> previous_phi_;
  int corrections_ = 0;               // since the momentum was restarted
  std::vector<Record> displacement_;  // [H], with one more for the padding
};

void PcisphSplit::explicit_terms(StepState& state) {
  state.gradient.resize(state.size());
  run_explicit_sums(state, Sums(fluid_.sums(state.dt), state.gradient), true);
  add_wall_density(state);
  add_image_gradients(state, state.gradient);
}

void PcisphSplit::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  begin_step(state, pressure);
  iterate(state);
  write(loop_, report);
  const double to_velocity = fluid_.support_radius / state.dt, scale = fluid_.phi_per_pascal(state.dt);
  state.for_each([&](std::size_t i) {
    state.dv[i] += to_velocity * pair_displacement<Sum4>(state, phi_, i);
    pressure[i] = static_cast<double>(phi_[i]) / scale;
  });
  walls_.apply(state, phi_);
  shift_.find(state, report);
}

void PcisphSplit::begin_step(StepState& state, const std::vector<double>& pressure) {
  OILSKIN_ASSERT(pressure.size() >= state.size() && state.velocity.size() == state.size() + 1);
  loop_.begin_step();
  walls_.begin_step(state);
  set_velocity_targets(state, target_);
  drift_.resize(state.size());
  phi_.resize(state.size() + 1);
  phi_.back() = 0;
  previous_phi_.resize(state.size());
  displacement_.resize(state.size() + 1);
  displacement_.back() = Record{0, 0, 0, 0};
  const double warm_start = 2 * fluid_.warm_start(state);
  state.for_each([&](std::size_t i) {
    const Record& v = state.velocity[i];
    drift_[i] = (Vec3(v.x, v.y, v.z) + state.dv[i]) * (state.dt / fluid_.support_radius);
    phi_[i] = static_cast<float>(warm_start * pressure[i]);
  });
}

void PcisphSplit::restart_momentum(const StepState& state) {
  corrections_ = 0;
  state.for_each([&](std::size_t i) { previous_phi_[i] = phi_[i]; });
}

void PcisphSplit::iterate(StepState& state) {
  restart_momentum(state);
  loop_.start(
      {velocity_tolerance * fluid_.settings.divergence_tolerance, fluid_.settings.min_iterations, {}});
  PressureLoop::Verdict verdict;
  do {
    predict_positions(state);
    verdict = loop_.judge(correct(state));
    if (!verdict.finite) std::fill(phi_.begin(), phi_.end(), 0.0f);
    if (verdict.restart) restart_momentum(state);
  } while (!verdict.stop);
}

/// dt (v + dt a) under the current pressures, in units of H.
void PcisphSplit::predict_positions(StepState& state) {
  walls_.predict_walls(state, phi_);
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    ContactCursor contacts(state.contacts, begin);
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 d = drift_[i] + pair_displacement<F4>(state, phi_, i);
      walls_.constrain(state, i, phi_[i], contacts.of(i), d);
      displacement_[i] = to_record(d);
    }
  });
}

/// At the predicted positions, to first order in the displacement (F.26). The kernel itself, evaluated there,
/// is no measure of what a pressure does: it does not feel a particle that is pushed out of reach, whose
/// pressure then grows until the water bursts, at each impact with more than a fifth of a spacing per step.
float PcisphSplit::predicted_density(const StepState& state, std::size_t i) const {
  const float of_fluid = fluid_.density_scale * pair_compression(state, displacement_, i);
  const std::uint32_t k = WallResponse::point_of(state, i);
  if (k == Boundary::none) return state.relative_density[i] + of_fluid;
  return state.relative_density[i] + of_fluid + walls_.density(k) - state.boundary.points()[k].lambda;
}

/// φ ← max(0, φ + ω τ_i (e_i − ē_i)) with a momentum (F.27), (F.34). The clamp belongs inside the loop, or
/// free surfaces contract.
Errors PcisphSplit::correct(StepState& state) {
  const float step = static_cast<float>(loop_.relaxation() * fluid_.stiffness);
  const Momentum momentum(corrections_++);
  const auto add = [&](std::size_t i, float correction) {
    const float old = phi_[i];
    phi_[i] = std::max(0.0f, momentum.next(old, previous_phi_[i], correction));
    previous_phi_[i] = old;
  };
  const Errors result = state.ordered_sum(Errors{}, [&](std::size_t begin, std::size_t end) {
    Errors errors;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t k = WallResponse::point_of(state, i);
      const float density = predicted_density(state, i);
      // Γ of the modes (F.21) is proportional to the square of the number density: so ω τ decreases with it.
      const float compressed = std::max(1.0f, state.relative_density[i]);
      const float own_step = step / (compressed * compressed), error = density - 1 - target_[i];
      errors.add_residual(static_cast<double>(error),
                          static_cast<double>(phi_[i] > 0 ? std::abs(error) : std::max(error, 0.0f)));
      if (k == Boundary::none)
        add(i, own_step * error);
      else
        walls_.collect(
            k, phi_[i] > 0 || error > 0 ? step_at_walls(fluid_, state.boundary.points()[k], own_step) : 0,
            error);
    }
    return errors;
  });
  const std::vector<float>& change = walls_.solve(state);
  const std::vector<WallPoint>& points = state.boundary.points();
  for (std::size_t k = 0; k < points.size(); ++k) add(points[k].particle, change[k]);
  return result;
}

}  // namespace

std::unique_ptr<PressureModel> make_pcisph_split(const FluidSettings& settings) {
  return std::make_unique<PcisphSplit>(settings);
}

}  // namespace oilskin::fluid
