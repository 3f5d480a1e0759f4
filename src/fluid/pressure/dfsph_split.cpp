/// Divergence-free SPH [Bender2015] with the cubic spline.
///
/// One pass over the pairs at the start of a step gives densities, gradients, viscosity and the factors α;
/// the loop then uses stored gradients. It finds the pressures that keep the velocities of the step from
/// compressing the fluid; the pair forces are applied once, in double. What error the density has is
/// corrected by positions alone (density_shift.h).
#include <limits>

#include "core/assert.h"
#include "fluid/pressure/contact_bounds.h"
#include "fluid/pressure/density_shift.h"
#include "fluid/pressure/gradient_correction.h"
#include "fluid/pressure/image_pairs.h"
#include "fluid/pressure/momentum.h"
#include "fluid/pressure/pressure_model.h"
#include "fluid/pressure/wall_response.h"

namespace oilskin::fluid {

namespace {

/// Sums over pairs from which α and the correction of the gradient follow.
struct Rates {
  GradientRates gradient;
  SecondMoments moments;

  void add(const Pairs& pairs, F4 slope, F4 dv_dot_delta) {
    gradient.add(pairs, slope, dv_dot_delta);
    moments.add(pairs, slope);
  }
};

class DfsphSplit : public PressureModel {
 public:
  explicit DfsphSplit(const FluidSettings& settings)
      : fluid_(settings),
        loop_(fluid_.max_relaxation, settings.max_iterations),
        walls_(fluid_, true),
        shift_(fluid_) {}

  double particle_volume() const override { return fluid_.settled_volume; }
  void explicit_terms(StepState& state) override;
  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;
  Memory memory() const override {
    return {loop_.relaxation(), controller_.iterations, controller_.settled_steps};
  }
  void set_memory(const Memory& memory) noexcept override {
    loop_.set_relaxation(memory.relaxation);
    controller_ = {memory.iterations, memory.settled_steps};
  }
  void visit(Archive& archive) override {
    loop_.visit(archive);
    controller_.visit(archive);
  }

 private:
  struct Sums;

  void begin_step(const StepState& state, const std::vector<double>& pressure);
  void set_steps(const StepState& state);
  void iterate(StepState& state);
  void finish(StepState& state, std::vector<double>& pressure);

  void restart_momentum(const StepState& state);
  Errors correct(StepState& state);
  void displace(StepState& state);
  float compression(const StepState& state, std::size_t i) const;

  const IncompressibleFluid fluid_;
  PressureLoop loop_;
  WallResponse walls_;
  IterationController controller_;
  GradientCorrection correction_;
  DensityShift shift_;

  // Of the particles, at the start
  std::vector<float> step_;    // τ_i: change of φ per relative compression, without ω
  std::vector<Vec3> drift_;    // displacement without pressure [H]
  std::vector<float> target_;  // ē_i

  // Of the loop; phi_ and displacement_ with one more for the padding
  std::vector<float> phi_, previous_phi_;
  std::vector<Record> displacement_;  // [H]
  int corrections_ = 0;               // since the momentum was restarted
};

struct DfsphSplit::Sums : IncompressibleSums {
  using Rates = fluid::Rates;
  static constexpr std::size_t per_pair = 3;
  GradientCorrection& correction;
  std::vector<Record>& gradient;

  Sums(const IncompressibleSums& sums, GradientCorrection& c, std::vector<Record>& g)
      : IncompressibleSums(sums), correction(c), gradient(g) {}

  static void store_pair(float* at, const Pairs& pairs, F4 slope) { store_gradients(at, pairs, slope); }
  void keep(const fluid::Rates& r, std::size_t i) const {
    gradient[i] = r.gradient.sum();
    correction.keep(i, r.moments, density_scale);
  }
};

void DfsphSplit::explicit_terms(StepState& state) {
  state.gradient.resize(state.size());
  correction_.resize(state.size());
  run_explicit_sums(state, Sums(fluid_.sums(state.dt), correction_, state.gradient), true);
  add_wall_density(state);
  add_image_gradients(state, correction_, fluid_.density_scale);
}

void DfsphSplit::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  OILSKIN_ASSERT(pressure.size() >= state.size() && state.gradient.size() == state.size());
  begin_step(state, pressure);
  set_steps(state);
  iterate(state);
  write(loop_, report);
  finish(state, pressure);
  shift_.find(state, report);
}

void DfsphSplit::begin_step(const StepState& state, const std::vector<double>& pressure) {
  const std::size_t n = state.size();
  loop_.begin_step();
  walls_.begin_step(state);
  correction_.build(state);
  set_velocity_targets(state, target_);
  drift_.resize(n);
  step_.resize(n);
  previous_phi_.resize(n);
  phi_.resize(n + 1);
  phi_[n] = 0;
  displacement_.resize(n + 1);
  displacement_[n] = Record{0, 0, 0, 0};
  const double dt_over_h = state.dt / fluid_.support_radius, warm_start = 2 * fluid_.warm_start(state);
  state.for_each([&](std::size_t i) {
    const Record& v = state.velocity[i];
    drift_[i] = dt_over_h * (Vec3(v.x, v.y, v.z) + state.dv[i]);
    phi_[i] = static_cast<float>(warm_start * pressure[i]);
  });
}

/// τ_i (F.30), with the corrected gradients.
void DfsphSplit::set_steps(const StepState& state) {
  state.for_each([&](std::size_t i) {
    OILSKIN_ASSERT(state.relative_density[i] < std::numeric_limits<float>::infinity());
    const Record& g = state.gradient[i];
    const float k = correction_.largest(i);
    const Eigen::Vector3f pull = correction_.at(i) * Eigen::Vector3f(g.x, g.y, g.z);
    const float response =
        density_response(fluid_, state, i, fluid_.density_scale * pull, fluid_.density_scale * k * k * g.w);
    step_[i] = density_step(fluid_, state.relative_density[i], response);
  });
}

void DfsphSplit::finish(StepState& state, std::vector<double>& pressure) {
  const double to_velocity = fluid_.support_radius / state.dt, scale = fluid_.phi_per_pascal(state.dt);
  correction_.set_pressures(state, phi_);
  state.for_each([&](std::size_t i) {
    state.dv[i] += to_velocity * correction_.displacement<Sum4>(state, i);
    pressure[i] = static_cast<double>(phi_[i]) / scale;
  });
  walls_.apply(state, phi_);
  controller_ = loop_.next_controller();
}

void DfsphSplit::restart_momentum(const StepState& state) {
  corrections_ = 0;
  state.for_each([&](std::size_t i) { previous_phi_[i] = phi_[i]; });
}

void DfsphSplit::iterate(StepState& state) {
  restart_momentum(state);
  loop_.start({velocity_tolerance * fluid_.settings.divergence_tolerance, fluid_.settings.min_iterations,
               controller_});
  PressureLoop::Verdict verdict;
  do {
    displace(state);
    verdict = loop_.judge(correct(state));
    if (!verdict.finite) std::fill(phi_.begin(), phi_.end(), 0.0f);
    if (verdict.restart) restart_momentum(state);
  } while (!verdict.stop);
}

/// φ ← max(0, φ + ω τ error) with a momentum (F.34). The clamp belongs inside the loop, or free surfaces
/// contract. A pressure that expands the fluid is an error as well as one that lets it be compressed: it
/// makes energy.
Errors DfsphSplit::correct(StepState& state) {
  const Momentum momentum(corrections_++);
  const float relaxation = static_cast<float>(loop_.relaxation());
  const auto add = [&](std::size_t i, float correction) {
    const float old = phi_[i];
    phi_[i] = std::max(0.0f, momentum.next(old, previous_phi_[i], relaxation * correction));
    previous_phi_[i] = old;
  };
  const Errors result = state.ordered_sum(Errors{}, [&](std::size_t begin, std::size_t end) {
    Errors errors;
    for (std::size_t i = begin; i < end; ++i) {
      const float error = state.relative_density[i] - 1 - target_[i] + compression(state, i);
      errors.add_residual(static_cast<double>(error),
                          static_cast<double>(phi_[i] > 0 ? std::abs(error) : std::max(error, 0.0f)));
      const std::uint32_t point = WallResponse::point_of(state, i);
      if (point == Boundary::none)
        add(i, step_[i] * error);
      else
        walls_.collect(point, phi_[i] > 0 || error > 0 ? step_[i] : 0, error);
    }
    return errors;
  });
  const std::vector<float>& change = walls_.solve(state);
  const std::vector<WallPoint>& points = state.boundary.points();
  for (std::size_t p = 0; p < points.size(); ++p) add(points[p].particle, change[p]);
  return result;
}

/// Displacements under the current pressures.
void DfsphSplit::displace(StepState& state) {
  walls_.predict_walls(state, phi_);
  correction_.set_pressures(state, phi_);
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    ContactCursor contacts(state.contacts, begin);
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 d = drift_[i] + correction_.displacement<F4>(state, i);
      walls_.constrain(state, i, phi_[i], contacts.of(i), d);
      displacement_[i] = to_record(d);
    }
  });
}

/// div_i (F.56): dt Dρ/Dt/ρ0 at the current displacements.
float DfsphSplit::compression(const StepState& state, std::size_t i) const {
  const float of_fluid = fluid_.density_scale * correction_.compression(state, displacement_, i);
  const std::uint32_t k = WallResponse::point_of(state, i);
  if (k == Boundary::none) return of_fluid;
  return of_fluid + walls_.density(k) - state.boundary.points()[k].lambda;
}

}  // namespace

std::unique_ptr<PressureModel> make_dfsph_split(const FluidSettings& settings) {
  return std::make_unique<DfsphSplit>(settings);
}

}  // namespace oilskin::fluid
