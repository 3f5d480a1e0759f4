/// Divergence-free SPH [Bender2015] with the cubic spline.
///
/// One pass over the pairs at the start of a step gives densities, gradients, viscosity, the factors α and
/// the rates of compression; the loops then use its slopes. Both solvers write one set of pressures:
/// the divergence solver finds those that keep the start velocities from compressing the fluid beyond ρ0, the
/// density solver raises them until the density at the end of the step is ρ0. The pair forces are applied
/// once, in double. Viscosity acts on the velocities before the divergence solver, which saves a pass; the
/// order of the two makes a difference of second order in dt.
#include <limits>

#include "core/assert.h"
#include "fluid/pressure/contact_bounds.h"
#include "fluid/pressure/density_response.h"
#include "fluid/pressure/energy_bound.h"
#include "fluid/pressure/gradient_correction.h"
#include "fluid/pressure/image_pairs.h"
#include "fluid/pressure/momentum.h"
#include "fluid/pressure/pressure_loop.h"
#include "fluid/pressure/pressure_model.h"
#include "fluid/pressure/wall_response.h"

namespace oilskin::fluid {

namespace {

/// A particle with fewer neighbours is spray: its density does not measure compression [Bender2015,
/// Sec. 3.3].
constexpr float min_neighbours = 20;

class Dfsph : public PressureModel {
 public:
  explicit Dfsph(const FluidSettings& settings)
      : fluid_(settings),
        loop_(fluid_.max_relaxation, settings.max_iterations),
        walls_(fluid_, WallDensity::linear),
        correction_(settings.gradient_correction) {}

  double particle_volume() const override { return fluid_.settled_volume; }
  void explicit_terms(StepState& state) override;
  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;
  void limit_iterations(int most) override { loop_.limit_iterations(most); }
  Memory memory() const override { return {loop_.relaxation(), controller_}; }
  void set_memory(const Memory& memory) noexcept override {
    loop_.set_relaxation(memory.relaxation);
    controller_ = memory.controller;
  }
  void visit(Archive& archive) override {
    loop_.visit(archive);
    controller_.visit(archive);
  }

 private:
  enum class Solver { divergence, density };

  void begin_step(const StepState& state);
  void set_steps(const StepState& state);
  bool has_neighbours(const StepState& state, std::size_t i) const;
  void solve_divergence(StepState& state, FluidReport& report);
  Eigen::Vector3f start_displacement(const StepState& state, std::size_t i) const;
  Vec3 drift(const StepState& state, Solver solver, std::size_t i) const;
  void add_wall_rates(const StepState& state);
  void solve_density(StepState& state, const std::vector<double>& pressure, FluidReport& report);
  void finish(StepState& state, std::vector<double>& pressure);

  void restart_momentum(const StepState& state);
  void iterate(StepState& state, Solver solver, const LoopGoal& goal);
  float divergence_error(const StepState& state, std::size_t i, float rate, Errors& errors) const;
  float density_error(const StepState& state, std::size_t i, float compressed, Errors& errors) const;
  template <class RateOf, class ErrorOf>
  Errors correct(StepState& state, const RateOf& rates_of, const ErrorOf& error_of);
  void displace(StepState& state, Solver solver);
  void compression(StepState& state, PairRange range, float* out) const;

  const IncompressibleFluid fluid_;
  PressureLoop loop_;  // of both solvers: they share ω
  WallResponse walls_;
  GradientCorrection correction_;
  IterationController controller_;  // of the density solver

  // Of the particles, at the start
  std::vector<Record> gradient_;   // Σ w'/q Δ, if corrected Σ w'/q K_i Δ, and w: Σ |w'|²
  std::vector<float> start_rate_;  // relative compression of the step by the start velocities
  std::vector<float> step_;        // τ_i: change of φ per relative compression, without ω
  std::vector<float> target_;      // ē_i

  // Of the loops; x_phi_ and displacement_ with one more for the padding
  std::vector<Record> x_phi_;  // positions and φ
  std::vector<float> previous_phi_;
  std::vector<float> min_phi_;        // of the divergence solver: a lower bound for the density solver
  std::vector<Record> displacement_;  // [H]
  int corrections_ = 0;               // since the momentum was restarted
};

void Dfsph::explicit_terms(StepState& state) {
  gradient_.resize(state.size());
  start_rate_.resize(state.size());
  const ExplicitModel model = fluid_.explicit_model(state.dt);
  const float rate_scale = model.density_scale * static_cast<float>(state.dt / fluid_.support_radius);
  TensorArray& moments = correction_.moments();
  if (correction_.is_on()) moments.resize(state.size());
  run_explicit_sums(state, model, true, [&](const PairRates& rates, std::size_t i) {
    gradient_[i] = rates.gradient;
    start_rate_[i] = rate_scale * rates.compression;
    if (correction_.is_on()) moments.set(i, rates.moments);
  });
  add_wall_density(state);
  add_image_slopes(state, gradient_, moments);
}

void Dfsph::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  OILSKIN_ASSERT(pressure.size() >= state.size() && gradient_.size() == state.size());
  begin_step(state);
  if (correction_.is_on()) correction_.begin_step(state, gradient_, fluid_.density_scale);
  set_steps(state);
  solve_divergence(state, report);
  solve_density(state, pressure, report);
  finish(state, pressure);
}

void Dfsph::begin_step(const StepState& state) {
  const std::size_t n = state.size();
  loop_.begin_step();
  walls_.begin_step(state);
  set_targets(state, fluid_.settings, target_);
  step_.resize(n);
  previous_phi_.resize(n);
  min_phi_.assign(n, 0);
  x_phi_ = state.position();  // φ = 0
  displacement_.resize(n + 1);
  displacement_[n] = Record{0, 0, 0, 0};
}

/// τ_i (F.30).
void Dfsph::set_steps(const StepState& state) {
  const float scale = fluid_.density_scale;
  state.for_each([&](std::size_t i) {
    OILSKIN_ASSERT(std::max(1.0f, state.relative_density[i]) < std::numeric_limits<float>::infinity());
    const Record& g = gradient_[i];
    const Eigen::Vector3f pull = scale * Eigen::Vector3f(g.x, g.y, g.z);
    const float response = density_response(fluid_, state, i, pull, scale * g.w);
    step_[i] = density_step(fluid_, state.relative_density[i], response);
  });
}

bool Dfsph::has_neighbours(const StepState& state, std::size_t i) const {
  const std::uint32_t k = state.wall_point_of(i);
  const float behind_walls = k == Boundary::none ? 0 : state.boundary.points()[k].lambda;
  return static_cast<float>(state.neighbours.count(i)) >= (1 - behind_walls) * min_neighbours;
}

/// The start velocities compress the fluid by no more than the tolerance in the step: Dρ/Dt = Σ m (v_i −
/// v_j)·∇W (F.31), [Bender2015] Alg. 2. In most steps they do not, as the first pass over the pairs shows.
void Dfsph::solve_divergence(StepState& state, FluidReport& report) {
  add_wall_rates(state);
  restart_momentum(state);
  const auto start_rates = [&](PairRange range, float* out) {
    std::copy(&start_rate_[range.begin], &start_rate_[range.begin] + (range.end - range.begin), out);
  };
  const auto error_of = [&](std::size_t i, float rate, Errors& errors) {
    return divergence_error(state, i, rate, errors);
  };
  const Errors at_start = correct(state, start_rates, error_of);
  const double tolerance = fluid_.settings.divergence_tolerance;
  if (!(at_start.mean(at_start.sum) > tolerance)) return;
  iterate(state, Solver::divergence, {tolerance, 1, {}});
  report.divergence_iterations = loop_.iterations();
  report.diverged = loop_.diverged();
  state.for_each([&](std::size_t i) { min_phi_[i] = x_phi_[i].w; });
}

/// By the start velocity [H].
Eigen::Vector3f Dfsph::start_displacement(const StepState& state, std::size_t i) const {
  const Record& v = state.velocity[i];
  return static_cast<float>(state.dt / fluid_.support_radius) * Eigen::Vector3f(v.x, v.y, v.z);
}

/// The displacement without pressure [H]. Computed where it is needed: an array of it takes 24 bytes a
/// particle.
Vec3 Dfsph::drift(const StepState& state, Solver solver, std::size_t i) const {
  const Vec3 d = start_displacement(state, i).cast<double>();
  return solver == Solver::divergence ? d : Vec3(d + state.dt / fluid_.support_radius * state.dv[i]);
}

/// The walls' part of the compression by the start velocities.
void Dfsph::add_wall_rates(const StepState& state) {
  const float dt_over_h = static_cast<float>(state.dt / fluid_.support_radius);
  state.for_each([&](std::size_t i) {
    const std::uint32_t k = state.wall_point_of(i);
    if (k != Boundary::none)
      start_rate_[i] += dt_over_h * state.boundary.normal_flux()[k] -
                        state.boundary.points()[k].gamma.dot(start_displacement(state, i));
  });
}

/// Unlike the published solver this one lets a fluid close its gaps up to ρ0: else falling water stops half a
/// support radius above what it falls on, and a light sheet that swings back is hit before it touches.
float Dfsph::divergence_error(const StepState& state, std::size_t i, float rate, Errors& errors) const {
  if (!has_neighbours(state, i)) return 0;
  const float error = rate + std::min(0.0f, state.relative_density[i] - 1);
  errors.add(static_cast<double>(error), 0, std::numeric_limits<double>::infinity());
  return error;
}

/// ρ* = ρ + dt Dρ/Dt = ρ0 where compressed (F.32), [Bender2015] Alg. 3.
void Dfsph::solve_density(StepState& state, const std::vector<double>& pressure, FluidReport& report) {
  const double warm_start = fluid_.warm_start(state);
  state.for_each([&](std::size_t i) {
    x_phi_[i].w = std::max(min_phi_[i], static_cast<float>(warm_start * pressure[i]));
  });
  restart_momentum(state);
  iterate(state, Solver::density,
          {fluid_.error_per_step(state), fluid_.settings.min_iterations, controller_});
  write(loop_, report);
  controller_ = loop_.next_controller(state.dt);
  bound_energy(
      fluid_, loop_, state, x_phi_, [&] { displace(state, Solver::density); },
      [&](std::size_t i) { return to_vector(displacement_[i]); });
}

float Dfsph::density_error(const StepState& state, std::size_t i, float compressed, Errors& errors) const {
  const float error = state.relative_density[i] - 1 + compressed;
  errors.add(static_cast<double>(error), static_cast<double>(target_[i]), fluid_.settings.tolerance);
  return error - target_[i];
}

void Dfsph::finish(StepState& state, std::vector<double>& pressure) {
  const double per_displacement = fluid_.support_radius / state.dt;
  if (correction_.is_on())
    correction_.apply_pressure(state, x_phi_, per_displacement);
  else
    apply_pressure(state, x_phi_, per_displacement);
  walls_.apply(state, x_phi_);
  const double scale = fluid_.phi_per_pascal(state.dt);
  state.for_each([&](std::size_t i) { pressure[i] = static_cast<double>(x_phi_[i].w) / scale; });
}

void Dfsph::restart_momentum(const StepState& state) {
  corrections_ = 0;
  state.for_each([&](std::size_t i) { previous_phi_[i] = x_phi_[i].w; });
}

void Dfsph::iterate(StepState& state, Solver solver, const LoopGoal& goal) {
  loop_.start(goal);
  const auto rates_of = [&](PairRange range, float* out) { compression(state, range, out); };
  const auto error_of = [&](std::size_t i, float rate, Errors& errors) {
    return solver == Solver::density ? density_error(state, i, rate, errors)
                                     : divergence_error(state, i, rate, errors);
  };
  PressureLoop::Verdict verdict;
  do {
    displace(state, solver);
    verdict = loop_.judge(correct(state, rates_of, error_of));
    if (!verdict.finite) state.for_each([&](std::size_t i) { x_phi_[i].w = min_phi_[i]; });
    if (verdict.restart) restart_momentum(state);
  } while (!verdict.stop);
}

/// φ ← max(φ_min, φ + ω τ error) with a momentum (F.34). With a warm start of one half, solves that overshoot
/// by more than 0.2 make the pressure oscillate from step to step. The clamp belongs inside the loop, or free
/// surfaces contract. rates_of(range, out) writes the relative compressions of the step; error_of(i, rate,
/// errors) returns the error that the pressure of i should remove, and adds it to `errors`.
template <class RateOf, class ErrorOf>
Errors Dfsph::correct(StepState& state, const RateOf& rates_of, const ErrorOf& error_of) {
  const float weight = Momentum(corrections_++).weight, momentum = weight - 1;
  const float relaxation = weight * static_cast<float>(loop_.relaxation());
  const auto add = [&](std::size_t i, float correction) {
    float& phi = x_phi_[i].w;
    const float change = relaxation * correction + momentum * (phi - previous_phi_[i]);
    previous_phi_[i] = phi;
    phi = std::max(min_phi_[i], phi + change);
  };
  const Errors result = state.ordered_sum(Errors{}, [&](std::size_t begin, std::size_t end) {
    Errors errors;
    float rate[chunk_size];
    rates_of({begin, end}, rate);
    for (std::size_t i = begin; i < end; ++i) {
      const float error = error_of(i, rate[i - begin], errors);
      const std::uint32_t point = state.wall_point_of(i);
      if (point == Boundary::none)
        add(i, step_[i] * error);
      else
        walls_.collect(point, x_phi_[i].w > min_phi_[i] || error > 0 ? step_[i] : 0, error);
    }
    return errors;
  });
  const std::vector<float>& change = walls_.solve(state);
  const std::vector<WallPoint>& points = state.boundary.points();
  state.workers.for_each(points.size(), chunk_size,
                         [&](std::size_t p) { add(points[p].particle, change[p]); });
  return result;
}

/// Displacements under the current pressures.
void Dfsph::displace(StepState& state, Solver solver) {
  walls_.predict_walls(state, x_phi_);
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    ContactCursor contacts(state.contacts, begin);
    Record push[chunk_size];
    if (correction_.is_on())
      correction_.push(state, x_phi_, gradient_, {begin, end}, push);
    else
      pair_kernels().pressure(pair_table(state, begin), x_phi_.data(), {begin, end}, push);
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 d = drift(state, solver, i) - to_vector(push[i - begin]);
      walls_.constrain(state, i, x_phi_[i].w, contacts.of(i), d);
      displacement_[i] = to_record(d);
    }
  });
}

/// div_i (F.29): dt Dρ/Dt/ρ0 at the current displacements.
void Dfsph::compression(StepState& state, PairRange range, float* out) const {
  // Not x_phi_: another chunk may be writing a φ beside the position that this one reads.
  if (correction_.is_on())
    correction_.compression(state, displacement_, range, out);
  else
    pair_kernels().compression(pair_table(state, range.begin), state.position().data(), displacement_.data(),
                               range, out);
  for (std::size_t i = range.begin; i < range.end; ++i, ++out) {
    *out *= fluid_.density_scale;
    const std::uint32_t k = state.wall_point_of(i);
    if (k != Boundary::none) *out += walls_.density(k) - state.boundary.points()[k].lambda;
  }
}

}  // namespace

std::unique_ptr<PressureModel> make_dfsph(const FluidSettings& settings) {
  return std::make_unique<Dfsph>(settings);
}

}  // namespace oilskin::fluid
