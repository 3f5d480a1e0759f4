/// Predictive–corrective incompressible SPH [Solenthaler2009] with the cubic spline.
#include "core/assert.h"
#include "fluid/incompressible.h"

namespace oilskin::fluid {

namespace {

using Kernel = CubicSpline;

/// |γ|² of one plane half a spacing away at H = 2 dx.
constexpr float plane_gamma2 = 4;

class Pcisph : public IncompressibleModel {
 public:
  explicit Pcisph(const FluidSettings& settings) : IncompressibleModel(settings) {}

  void explicit_terms(StepState& state) override {
    run_explicit_sums(state, sums(state.dt), settings_.viscosity > 0 || settings_.xsph_rate > 0);
    add_wall_density(state);
  }

  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;

 private:
  void iterate_density(StepState& state, FluidReport& report);
  void predict_positions(StepState& state);
  Errors correct(StepState& state);
  float boundary_step(const Boundary& boundary, std::uint32_t point, float step) const;

  std::vector<Record> predicted_;
};

void Pcisph::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  begin(state);
  OILSKIN_ASSERT(pressure.size() >= state.size() && state.velocity.size() == state.size() + 1);
  predicted_.resize(state.size() + 1);
  predicted_[state.size()] = state.position()[state.size()];  // the padding
  const double factor = warm_start(state), scale = phi_per_pascal(state.dt);
  state.for_each([&](std::size_t i) {
    const Record& v = state.velocity[i];
    drift_[i] = (Vec3(v.x, v.y, v.z) + state.dv[i]) * (state.dt / support_radius_);
    state.position()[i].w = static_cast<float>(factor * pressure[i]);
  });
  iterate_density(state, report);
  apply_pressure(state, support_radius_ / state.dt);
  push_from_walls(state, [&](std::size_t i) { return state.position()[i].w; });
  state.for_each([&](std::size_t i) { pressure[i] = static_cast<double>(state.position()[i].w) / scale; });
}

void Pcisph::iterate_density(StepState& state, FluidReport& report) {
  PressureLoop loop;
  loop.tolerance = settings_.tolerance;
  loop.min_iterations = settings_.min_iterations;
  iterate(
      loop,
      [&] {
        predict_positions(state);
        return correct(state);
      },
      [&](bool finite) {
        if (!finite) state.for_each([&](std::size_t i) { state.position()[i].w = 0; });
      });
  write(loop, report);
}

/// x* = x + dt (v + dt a), with the pressures of now.
void Pcisph::predict_positions(StepState& state) {
  predict(
      state, [&](std::size_t i) { return state.position()[i].w; },
      [&](std::size_t i) { return Vec3(-pressure_sum<F4>(state, i)); },
      [&](std::size_t i, const Vec3& d) {
        const Record& x = state.position()[i];
        predicted_[i] = {x.x + static_cast<float>(d[0]), x.y + static_cast<float>(d[1]),
                         x.z + static_cast<float>(d[2]), 0};
      });
}

/// A corner of walls pushes more than the lattice for which δ was made: the step shrinks by what the density
/// answers to the particle's pressure through its walls.
float Pcisph::boundary_step(const Boundary& boundary, std::uint32_t point, float step) const {
  const float corner = std::max(0.0f, boundary.points()[point].gamma.squaredNorm() - plane_gamma2);
  return step / (1 + step * push_scale_ * corner);
}

/// p ← max(0, p + ω δ (ρ* − ρ0)) at the predicted positions; the clamp belongs inside the loop, or free
/// surfaces contract.
Errors Pcisph::correct(StepState& state) {
  const float step = static_cast<float>(relaxation_ * stiffness_);
  const Errors result = state.workers.ordered_sum(
      state.size(), Neighbours::chunk_size, Errors{}, [&](std::size_t b, std::size_t e) {
        Errors errors;
        for (std::size_t i = b; i < e; ++i) {
          float density =
              self_density_ + density_scale_ * density_sum<Kernel>(state.neighbours, predicted_, i);
          const std::uint32_t wall = wall_of(state, i);
          if (wall != Boundary::none) density += wall_density_[wall];
          float& phi = state.position()[i].w;
          // |S|² of the modes (lattice.h) grows with the square of the number density: so must ω δ shrink.
          const float compressed = std::max(1.0f, state.relative_density[i]);
          float own_step = step / (compressed * compressed);
          const float error = density - 1 - target_[i];
          if (wall == Boundary::none)
            phi = std::max(0.0f, phi + own_step * error);
          else
            leave_to_walls(wall, phi > 0 || error > 0 ? boundary_step(state.boundary, wall, own_step) : 0,
                           error);
          errors.add(static_cast<double>(density) - 1, static_cast<double>(target_[i]), settings_.tolerance);
        }
        return errors;
      });
  correct_at_walls(state, [&](std::size_t i, float correction) {
    float& phi = state.position()[i].w;
    phi = std::max(0.0f, phi + correction);
  });
  return result;
}

}  // namespace

std::unique_ptr<PressureModel> make_pcisph(const FluidSettings& settings) {
  return std::make_unique<Pcisph>(settings);
}

}  // namespace oilskin::fluid
