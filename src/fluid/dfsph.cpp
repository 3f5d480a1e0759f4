/// Divergence-free SPH [Bender2015] with the cubic spline.
///
/// One pass over the pairs at the start of a step gives densities, gradients, viscosity, the factors α and
/// the rates of compression; the loops then go over stored gradients. Both solvers write the same pressures:
/// the divergence solver finds those that keep the start velocities from compressing the fluid beyond ρ0, the
/// density solver raises them until the density at the end of the step is ρ0. What pairs push is applied
/// once, in double. Viscosity acts on the velocities as they were before the divergence solver, which saves a
/// pass: the order of the two makes a difference of second order in dt.
#include <limits>

#include "core/assert.h"
#include "fluid/incompressible.h"

namespace oilskin::fluid {

namespace {

/// A particle with fewer neighbours is spray: its density says nothing about compression [Bender2015,
/// Sec. 3.3].
constexpr float min_neighbours = 20;

/// Denominators of α that are smaller, relative to that of the lattice, belong to isolated particles, or to
/// particles that all but coincide: no pressure parts those, and α of their own would make it 1e12 Pa, which
/// throws whatever else is near.
constexpr float min_response = 0.1f;

/// Of the ultraspherical polynomials, see Dfsph::correct().
constexpr float polynomial_order = 2.5;

/// Sums over pairs from which a particle's α and rate of compression follow.
struct Rates {
  F4 gx, gy, gz, squares, compression;

  void add(const Pairs& pairs, F4 slope, F4 dv_dot_delta) {
    gx += slope * pairs.dx;
    gy += slope * pairs.dy;
    gz += slope * pairs.dz;
    squares += slope * slope * pairs.q2;
    compression += slope * dv_dot_delta;
  }
};

class Dfsph : public IncompressibleModel {
 public:
  explicit Dfsph(const FluidSettings& settings) : IncompressibleModel(settings) {}

  void explicit_terms(StepState& state) override;
  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;
  Memory memory() const override { return {relaxation_, controller_.iterations, controller_.settled_steps}; }
  void set_memory(const Memory& memory) noexcept override {
    IncompressibleModel::set_memory(memory);
    controller_.iterations = memory.iterations;
    controller_.settled_steps = memory.settled_steps;
  }
  void visit(Archive& archive) override {
    IncompressibleModel::visit(archive);
    controller_.visit(archive);
  }

 private:
  struct Sums;

  void resize(const StepState& state);
  float response(const StepState& state, std::size_t i) const;
  void set_steps(const StepState& state);
  bool has_neighbours(const StepState& state, std::size_t i) const;
  void solve_divergence(StepState& state, FluidReport& report);
  void solve_density(StepState& state, const std::vector<double>& pressure, FluidReport& report);
  void finish(StepState& state, std::vector<double>& pressure);

  void start_loop(const StepState& state);
  template <class ErrorOf>
  void solve(StepState& state, PressureLoop& loop, const ErrorOf& error_of);
  template <class ErrorOf>
  Errors correct(StepState& state, const ErrorOf& error_of);
  void displace(StepState& state);
  template <class Sum>
  Vec3 push(const StepState& state, std::size_t i) const;
  float compression(const StepState& state, std::size_t i) const;
  static const float* gradients(const StepState& state, std::size_t i) {
    return state.slope[i / Neighbours::chunk_size].data() + 3 * state.neighbours.pair_begin(i);
  }

  // Of the particles, at the start
  std::vector<Record> gradient_;   // Σ w'/q Δ, and w: Σ |w'|²
  std::vector<float> start_rate_;  // compression of the step by the start velocities, relative
  std::vector<float> step_;        // φ per relative compression, without ω

  // Of the loops; phi_ and displacement_ with one more for the padding
  std::vector<float> phi_, previous_phi_;
  std::vector<float> min_phi_;        // by the divergence solver; the density solver does not undo it
  std::vector<Record> displacement_;  // in units of H
  int corrections_ = 0;               // of this loop
  IterationController controller_;    // of the density solver
};

struct Dfsph::Sums : IncompressibleSums {
  using Rates = fluid::Rates;
  static constexpr std::size_t per_pair = 3;
  Dfsph& out;
  float rate_scale;

  Sums(const IncompressibleSums& sums, Dfsph& model, double dt)
      : IncompressibleSums(sums),
        out(model),
        rate_scale(density_scale * static_cast<float>(dt / model.support_radius_)) {}

  static void store_pair(float* at, const Pairs& pairs, F4 slope) {
    store(at, slope * pairs.dx);
    store(at + 4, slope * pairs.dy);
    store(at + 8, slope * pairs.dz);
  }
  void keep(const fluid::Rates& r, std::size_t i) const {
    out.gradient_[i] = {total(r.gx), total(r.gy), total(r.gz), total(r.squares)};
    out.start_rate_[i] = rate_scale * total(r.compression);
  }
};

void Dfsph::explicit_terms(StepState& state) {
  gradient_.resize(state.size());
  start_rate_.resize(state.size());
  run_explicit_sums(state, Sums(sums(state.dt), *this, state.dt), true);
  add_wall_density(state);
}

void Dfsph::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  begin(state);
  OILSKIN_ASSERT(pressure.size() >= state.size() && gradient_.size() == state.size());
  resize(state);
  set_steps(state);
  solve_divergence(state, report);
  solve_density(state, pressure, report);
  finish(state, pressure);
}

void Dfsph::resize(const StepState& state) {
  const std::size_t n = state.size();
  step_.resize(n);
  previous_phi_.resize(n);
  min_phi_.assign(n, 0);
  phi_.assign(n + 1, 0);
  displacement_.resize(n + 1);
  displacement_[n] = Record{0, 0, 0, 0};
}

/// By how much the density of particle i falls per φ_i, 1/α (F.28), [Bender2015] Eq. 8 in our units.
/// The image of a particle behind a wall has its pressure.
float Dfsph::response(const StepState& state, std::size_t i) const {
  const Record& g = gradient_[i];
  const Eigen::Vector3f pull = density_scale_ * Eigen::Vector3f(g.x, g.y, g.z);
  const float of_neighbours = density_scale_ * g.w;
  const std::uint32_t wall = wall_of(state, i);
  if (wall == Boundary::none) return of_neighbours + push_scale_ * pull.squaredNorm();
  const Eigen::Vector3f& gamma = state.boundary.points()[wall].gamma;
  return of_neighbours + push_scale_ * (pull - gamma).squaredNorm();
}

/// Steps of the Jacobi iteration. Neighbours correct the same compression at the same time, so a step is half
/// of α, as δ of PCISPH is; where the fluid is compressed there are more of them.
void Dfsph::set_steps(const StepState& state) {
  const float minimum = min_response / static_cast<float>(2 * stiffness_);
  state.for_each([&](std::size_t i) {
    const float compressed = std::max(1.0f, state.relative_density[i]);
    OILSKIN_ASSERT(compressed < std::numeric_limits<float>::infinity());
    step_[i] = 0.5f / (std::max(response(state, i), minimum * compressed) * compressed);
  });
}

bool Dfsph::has_neighbours(const StepState& state, std::size_t i) const {
  const std::uint32_t wall = wall_of(state, i);
  const float behind_walls = wall == Boundary::none ? 0 : state.boundary.points()[wall].lambda;
  return static_cast<float>(state.neighbours.count(i)) >= (1 - behind_walls) * min_neighbours;
}

/// The start velocities compress the fluid by no more than the tolerance in the step: Dρ/Dt = Σ m (v_i −
/// v_j)·∇W (F.31), [Bender2015] Alg. 2. Mostly they do not, as the first pass over the pairs already
/// knows. Unlike the published solver this one lets a fluid close its gaps up to ρ0: else whatever falls
/// stops half a support radius above what it falls on, and a light sheet that swings back is hit before it
/// touches.
void Dfsph::solve_divergence(StepState& state, FluidReport& report) {
  const float dt_over_h = static_cast<float>(state.dt / support_radius_);
  state.for_each([&](std::size_t i) {
    const Record& v = state.velocity[i];
    const Eigen::Vector3f d = dt_over_h * Eigen::Vector3f(v.x, v.y, v.z);
    drift_[i] = d.cast<double>();
    const std::uint32_t wall = wall_of(state, i);
    if (wall != Boundary::none)
      start_rate_[i] +=
          dt_over_h * state.boundary.normal_flux()[wall] - state.boundary.points()[wall].gamma.dot(d);
  });
  const auto add = [&](Errors& errors, std::size_t i, float rate) {
    if (!has_neighbours(state, i)) return 0.0f;
    const float error = rate + std::min(0.0f, state.relative_density[i] - 1);
    errors.add(static_cast<double>(error), 0, std::numeric_limits<double>::infinity());
    return error;
  };
  start_loop(state);
  const Errors at_start =
      correct(state, [&](Errors& errors, std::size_t i) { return add(errors, i, start_rate_[i]); });
  if (at_start.mean(at_start.sum) > settings_.divergence_tolerance) {
    PressureLoop loop;
    loop.tolerance = settings_.divergence_tolerance;
    solve(state, loop, [&](Errors& errors, std::size_t i) { return add(errors, i, compression(state, i)); });
    report.divergence_iterations = loop.iterations;
    report.diverged = loop.diverged;
    std::copy(phi_.begin(), phi_.end() - 1, min_phi_.begin());
  }
}

/// ρ* = ρ + dt Dρ/Dt = ρ0 where compressed (F.32), [Bender2015] Alg. 3.
void Dfsph::solve_density(StepState& state, const std::vector<double>& pressure, FluidReport& report) {
  const double dt_over_h = state.dt / support_radius_, factor = warm_start(state);
  state.for_each([&](std::size_t i) {
    drift_[i] += dt_over_h * state.dv[i];
    phi_[i] = std::max(min_phi_[i], static_cast<float>(factor * pressure[i]));
  });
  start_loop(state);
  PressureLoop loop;
  loop.tolerance = settings_.tolerance;
  loop.min_iterations = settings_.min_iterations;
  loop.controller = controller_;
  solve(state, loop, [&](Errors& errors, std::size_t i) {
    const float error = state.relative_density[i] - 1 + compression(state, i);
    errors.add(static_cast<double>(error), static_cast<double>(target_[i]), settings_.tolerance);
    return error - target_[i];
  });
  write(loop, report);
  controller_ = loop.next_controller();
}

void Dfsph::finish(StepState& state, std::vector<double>& pressure) {
  const double to_velocity = support_radius_ / state.dt, scale = phi_per_pascal(state.dt);
  state.for_each([&](std::size_t i) {
    state.dv[i] += to_velocity * push<Sum4>(state, i);
    pressure[i] = static_cast<double>(phi_[i]) / scale;
  });
  push_from_walls(state, [&](std::size_t i) { return phi_[i]; });
}

void Dfsph::start_loop(const StepState& state) {
  corrections_ = 0;
  state.for_each([&](std::size_t i) { previous_phi_[i] = phi_[i]; });
}

/// error_of(errors, i) → what the pressure of i should take away, and adds it to the errors.
template <class ErrorOf>
void Dfsph::solve(StepState& state, PressureLoop& loop, const ErrorOf& error_of) {
  iterate(
      loop,
      [&] {
        displace(state);
        return correct(state, error_of);
      },
      [&](bool finite) {
        if (!finite) std::copy(min_phi_.begin(), min_phi_.end(), phi_.begin());
        start_loop(state);
      });
}

/// φ ← max(least, φ + ω step error), with a momentum that makes the residual after k corrections the k-th
/// ultraspherical polynomial in place of the k-th power of Jacobi's iteration matrix (F.34), the ν-methods of
/// [Hanke1991]: a column of N layers takes in the order of N corrections instead of N². From the second
/// correction on the residual of no mode is below −1/6. That matters: with a warm start of one half, steps in
/// time whose solves overshoot by more than 0.2 make the pressure swing from step to step. The clamp belongs
/// inside the loop, or free surfaces contract.
template <class ErrorOf>
Errors Dfsph::correct(StepState& state, const ErrorOf& error_of) {
  const float k = static_cast<float>(corrections_++), a = polynomial_order;
  const float weight = 2 * (k + a) / (k + 2 * a), momentum = weight - 1;
  const float relaxation = weight * static_cast<float>(relaxation_);
  const auto add = [&](std::size_t i, float correction) {
    const float change = relaxation * correction + momentum * (phi_[i] - previous_phi_[i]);
    previous_phi_[i] = phi_[i];
    phi_[i] = std::max(min_phi_[i], phi_[i] + change);
  };
  const Errors result = state.workers.ordered_sum(
      state.size(), Neighbours::chunk_size, Errors{}, [&](std::size_t begin, std::size_t end) {
        Errors errors;
        for (std::size_t i = begin; i < end; ++i) {
          const float error = error_of(errors, i);
          const std::uint32_t wall = wall_of(state, i);
          if (wall == Boundary::none)
            add(i, step_[i] * error);
          else
            leave_to_walls(wall, phi_[i] > min_phi_[i] || error > 0 ? step_[i] : 0, error);
        }
        return errors;
      });
  correct_at_walls(state, add);
  return result;
}

/// Where the pressures of now lead.
void Dfsph::displace(StepState& state) {
  predict(
      state, [&](std::size_t i) { return phi_[i]; }, [&](std::size_t i) { return push<F4>(state, i); },
      [&](std::size_t i, const Vec3& d) {
        displacement_[i] = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2]), 0};
      });
}

/// −Σ_j (φ_i + φ_j) w'/q Δ. `Sum` is F4 inside iterations and Sum4 (double) for what is applied.
template <class Sum>
Vec3 Dfsph::push(const StepState& state, std::size_t i) const {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* gradient = gradients(state, i);
  const F4 own(phi_[i]);
  Sum sx, sy, sz;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, gradient += 12) {
    const F4 both = own + gather(phi_.data(), j);
    sx += both * load(gradient);
    sy += both * load(gradient + 4);
    sz += both * load(gradient + 8);
  }
  return -total(sx, sy, sz);
}

/// dt Dρ/Dt/ρ0 at the displacements of now.
float Dfsph::compression(const StepState& state, std::size_t i) const {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* gradient = gradients(state, i);
  const Record& u = displacement_[i];
  F4 sum;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, gradient += 12) {
    const Record4 v(displacement_.data(), j);
    sum += (F4(u.x) - v.x) * load(gradient) + (F4(u.y) - v.y) * load(gradient + 4) +
           (F4(u.z) - v.z) * load(gradient + 8);
  }
  const float by_fluid = density_scale_ * total(sum);
  const std::uint32_t wall = wall_of(state, i);
  if (wall == Boundary::none) return by_fluid;
  return by_fluid + wall_density_[wall] - state.boundary.points()[wall].lambda;
}

}  // namespace

std::unique_ptr<PressureModel> make_dfsph(const FluidSettings& settings) {
  return std::make_unique<Dfsph>(settings);
}

}  // namespace oilskin::fluid
