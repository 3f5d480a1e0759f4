/// What the incompressible models, PCISPH and DFSPH, share: kernel and calibration, what a step is asked for,
/// the pressure of walls, when a pressure loop ends, and what is done when it grows instead.
///
/// Pressures are kept as φ = p dt² V c/(ρ0 H²), without dimension, so that a pair pushes particle i by
/// −(φ_i + φ_j) w'/q Δ in units of H within the step.
#pragma once

#include <cmath>

#include "core/assert.h"
#include "fluid/lattice.h"
#include "fluid/pair_sums.h"
#include "fluid/pressure_model.h"

namespace oilskin::fluid {

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

/// The sums at the start of a step: density, and viscosity with XSPH.
struct IncompressibleSums : DensityModel<CubicSpline> {
  using Gradient = CubicSpline;
  float by_slope, by_hat;  // 2 ν dt/H² times the weights

  IncompressibleSums(double volume, double support_radius, double smoothed_fraction, double viscosity_dt,
                     const ViscousWeights& weights);

  /// a_i = −2 ν/H² Σ φ(q) (v_ij·Δ) Δ: (F.10), [Monaghan2005] (a_i = 2(d+2) ν Σ V (v_ij·x_ij)/(|x_ij|² + 0.01
  /// H²) ∇W) with a second part that makes it isotropic on the lattice; conserves angular momentum too.
  Shear shear(const Pairs& pairs, F4 dv_dot_delta, F4 q, F4 slope, F4 w) const {
    const F4 u = larger(F4(1) - q, F4(0));
    return {dv_dot_delta * (F4(by_slope) * slope / (pairs.q2 + F4(0.01f)) - F4(by_hat) * u * u),
            F4(smoothing) * w};
  }
};

class IncompressibleModel : public PressureModel {
 public:
  static constexpr double min_relaxation = 1.0 / 256;

  double particle_volume() const override { return settled_volume_; }
  Memory memory() const override { return {relaxation_, 0, 0}; }
  void set_memory(const Memory& memory) noexcept override { relaxation_ = memory.relaxation; }
  void visit(Archive& archive) override;

 protected:
  explicit IncompressibleModel(const FluidSettings& settings);

  IncompressibleSums sums(double dt) const;

  /// After the densities are known: targets, and room for what the loops write.
  void begin(StepState& state);
  double phi_per_pascal(double dt) const;
  /// What φ of the last step's pressure [Pa] starts with.
  double warm_start(const StepState& state) const;

  /// What a loop that falls slowly knows of the steps before.
  struct IterationController {
    int iterations = 0;     // of the last step; 0 = fall at once
    int settled_steps = 0;  // steps in a row for which fewer would have done

    void visit(Archive& archive);
  };
  /// A pressure loop: correct() finds the errors under the pressures of now, then changes the pressures.
  struct PressureLoop {
    double tolerance = 0;  // of the mean error above target
    int min_iterations = 1;
    IterationController controller;
    int iterations = 0;
    Errors errors;
    bool converged = false, diverged = false;
    bool fewer_would_do = false;

    bool may_end(double mean);
    IterationController next_controller() const;
  };
  /// restart(finite) begins anew with a smaller ω, and without the pressures if they are not finite any more.
  template <class Correct, class Restart>
  void iterate(PressureLoop& loop, const Correct& correct, const Restart& restart);
  static void write(const PressureLoop& density, FluidReport& report);

  /// store(i, displacement of i in units of H) with the pressures phi(i) of now, which push i by push(i):
  /// drift + push, with the walls, and held on its side of the sheets.
  template <class Phi, class Push, class Store>
  void predict(StepState& state, const Phi& phi, const Push& push, const Store& store);

  /// Adds the pressures to what walls get and to dv of the particles at walls.
  template <class Phi>
  void push_from_walls(StepState& state, const Phi& phi);

  /// Particles at walls share nodes, which may be light: what one pressure changes others feel more than
  /// their own. So a loop's correction leaves their errors, with the steps that φ takes per error where walls
  /// do not give way, or 0 where it can neither rise nor fall; and add(i, change of φ) follows for all of
  /// them.
  void leave_to_walls(std::uint32_t point, float step, float error) {
    wall_step_[point] = step;
    wall_change_[point] = error;
  }
  template <class Add>
  void correct_at_walls(StepState& state, const Add& add);

  /// Point of the boundary of particle i, or none.
  static std::uint32_t wall_of(const StepState& state, std::size_t i) {
    return state.boundary.empty() ? Boundary::none : state.boundary.point_of(i);
  }

  const FluidSettings settings_;
  const double support_radius_;
  const double volume_;          // on the lattice at rest density: what the sums go by
  const double settled_volume_;  // in settled water: what a particle weighs
  const ViscousWeights viscous_weights_;
  float density_scale_ = 0, self_density_ = 0;
  double stiffness_ = 0;        // δ for φ against ρ*/ρ0 − 1
  double full_relaxation_ = 1;  // ω
  double relaxation_ = 1;       // of now; falls where a loop grows
  std::vector<Vec3> drift_;     // displacement without pressure, in units of H
  std::vector<float> target_;   // ρ*/ρ0 − 1 that the step aims at, 0 but for over-compressed particles

  // Boundary terms: per point of the boundary
  float push_scale_ = 0;             // displacement of a point in units of H per φ γ
  std::vector<float> wall_density_;  // λ* at the predicted positions

 private:
  template <class T>
  Boundary::Load<T> load_on_walls(const Boundary::Point& point, T phi) const;
  template <class Phi>
  void answer_of_walls(StepState& state, const Phi& phi);
  double rebound_limit(const StepState& state, std::size_t point, const Boundary::Load<double>& load) const;
  void keep_side(const StepState& state, Span<const PredictionContact> contacts, Vec3& displacement) const;
  bool diverges(double mean, double tolerance);

  double last_mean_ = 0;     // of the previous iteration
  int growing_ = 0;          // iterations in a row
  float phi_per_depth_ = 0;  // of water at rest, per H
  // Of points of the boundary
  std::vector<float> theta_;  // pressure on walls [m/s]
  std::vector<Boundary::Load<double>> final_load_;
  std::vector<float> wall_step_, wall_change_;
};

template <class Correct, class Restart>
void IncompressibleModel::iterate(PressureLoop& loop, const Correct& correct, const Restart& restart) {
  OILSKIN_ASSERT(loop.min_iterations >= 1 && loop.min_iterations <= settings_.max_iterations);
  last_mean_ = 0;
  growing_ = 0;
  for (loop.iterations = 1;; ++loop.iterations) {
    loop.errors = correct();
    const double mean = loop.errors.mean(loop.errors.above_target);
    loop.converged = mean <= loop.tolerance;
    if (loop.may_end(mean)) return;
    if (!std::isfinite(mean) || diverges(mean, loop.tolerance)) {
      restart(std::isfinite(mean));
      loop.diverged = true;
      relaxation_ = std::max(relaxation_ / 2, min_relaxation);  // begin() lets it rise again
      last_mean_ = 0;
      growing_ = 0;
    }
    if (loop.iterations >= settings_.max_iterations) return;
  }
}

/// In units of φ. What the water between particle and wall weighs counts up to the pressure of the particle:
/// a drop is carried by contact.
template <class T>
Boundary::Load<T> IncompressibleModel::load_on_walls(const Boundary::Point& point, T phi) const {
  const auto deepest = static_cast<T>(point.deepest), per_depth = static_cast<T>(phi_per_depth_);
  return {phi, per_depth * deepest < phi ? per_depth : deepest > 0 ? phi / deepest : 0};
}

/// Where the walls will be.
template <class Phi>
void IncompressibleModel::answer_of_walls(StepState& state, const Phi& phi) {
  if (state.boundary.empty()) return;
  const float per_phi = push_scale_ * static_cast<float>(support_radius_ / state.dt);
  const auto& points = state.boundary.points();
  for (std::size_t k = 0; k < points.size(); ++k) theta_[k] = per_phi * phi(points[k].particle);
  state.boundary.predict_wall_velocity(theta_, state.workers);
}

/// a_i = Σ (p_T/ρ0) γ_T/H.
template <class Phi>
void IncompressibleModel::push_from_walls(StepState& state, const Phi& phi) {
  if (state.boundary.empty()) return;
  const double per_phi = static_cast<double>(push_scale_) * support_radius_ / state.dt;
  const auto& points = state.boundary.points();
  final_load_.resize(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto load = load_on_walls(points[k], static_cast<double>(phi(points[k].particle))).times(per_phi);
    final_load_[k] = load.times(rebound_limit(state, k, load));
  }
  state.boundary.push(final_load_, state.dv, state.workers);
}

template <class Add>
void IncompressibleModel::correct_at_walls(StepState& state, const Add& add) {
  if (state.boundary.empty()) return;
  state.boundary.solve_yielding(push_scale_, wall_step_, wall_change_, state.workers);
  const auto& points = state.boundary.points();
  for (std::size_t k = 0; k < points.size(); ++k) add(points[k].particle, wall_change_[k]);
}

template <class Phi, class Push, class Store>
void IncompressibleModel::predict(StepState& state, const Phi& phi, const Push& push, const Store& store) {
  answer_of_walls(state, phi);
  const float dt_over_h = static_cast<float>(state.dt / support_radius_);
  state.workers.for_chunks(
      state.size(), Neighbours::chunk_size, [&](std::size_t begin, std::size_t end, std::size_t) {
        OILSKIN_ASSERT(end <= drift_.size());
        const PredictionContact* contact =
            std::lower_bound(state.contacts.begin(), state.contacts.end(), begin,
                             [](const PredictionContact& c, std::size_t i) { return c.particle < i; });
        for (std::size_t i = begin; i < end; ++i) {
          Vec3 d = drift_[i] + push(i);
          const std::uint32_t wall = wall_of(state, i);
          if (wall != Boundary::none) {
            const Boundary::Point& point = state.boundary.points()[wall];
            d += (push_scale_ * point.push(load_on_walls(point, phi(i)))).template cast<double>();
          }
          const PredictionContact* first = contact;
          while (contact != state.contacts.end() && contact->particle == i) ++contact;
          if (contact != first) keep_side(state, {first, static_cast<std::size_t>(contact - first)}, d);
          if (wall != Boundary::none) {
            const Boundary::Point& point = state.boundary.points()[wall];
            const float approach =
                dt_over_h * state.boundary.normal_flux()[wall] - point.gamma.dot(d.cast<float>());
            wall_density_[wall] = std::clamp(point.lambda + approach, 0.0f, 1.0f);
          }
          store(i, d);
        }
      });
}

}  // namespace oilskin::fluid
