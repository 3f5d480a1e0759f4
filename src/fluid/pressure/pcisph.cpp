/// Predictive–corrective incompressible SPH [Solenthaler2009] with the cubic spline.
#include "core/assert.h"
#include "fluid/pressure/contact_bounds.h"
#include "fluid/pressure/energy_bound.h"
#include "fluid/pressure/image_pairs.h"
#include "fluid/pressure/momentum.h"
#include "fluid/pressure/pressure_loop.h"
#include "fluid/pressure/pressure_model.h"
#include "fluid/pressure/wall_response.h"

namespace oilskin::fluid {

namespace {

class Pcisph : public PressureModel {
 public:
  explicit Pcisph(const FluidSettings& settings)
      : fluid_(settings),
        loop_(fluid_.max_relaxation, settings.max_iterations),
        walls_(fluid_, WallDensity::limited) {}

  double particle_volume() const override { return fluid_.settled_volume; }
  void explicit_terms(StepState& state) override;
  void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) override;
  void limit_iterations(int most) override { loop_.limit_iterations(most); }
  Memory memory() const override { return {loop_.relaxation(), {}}; }
  void set_memory(const Memory& memory) noexcept override { loop_.set_relaxation(memory.relaxation); }
  void visit(Archive& archive) override { loop_.visit(archive); }

 private:
  void begin_step(StepState& state, const std::vector<double>& pressure);
  void iterate(StepState& state);
  void predict_positions(StepState& state);
  Errors correct(StepState& state);
  void correct_at_walls(StepState& state);

  const IncompressibleFluid fluid_;
  PressureLoop loop_;
  WallResponse walls_;
  std::vector<float> target_;      // ē_i
  std::vector<Record> x_phi_;      // positions and φ, with one more for the padding
  std::vector<Record> predicted_;  // positions, with one more for the padding
};

void Pcisph::explicit_terms(StepState& state) {
  run_explicit_sums(state, fluid_.explicit_model(state.dt), has_friction(fluid_.settings), nullptr);
  add_wall_density(state);
  add_image_slopes(state);
}

void Pcisph::pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) {
  begin_step(state, pressure);
  iterate(state);
  write(loop_, report);
  bound_energy(
      fluid_, loop_, state, x_phi_, [&] { predict_positions(state); },
      [&](std::size_t i) { return Vec3(to_vector(predicted_[i]) - to_vector(x_phi_[i])); });
  apply_pressure(state, x_phi_, fluid_.support_radius / state.dt);
  walls_.apply(state, x_phi_);
  const double scale = fluid_.phi_per_pascal(state.dt);
  state.for_each([&](std::size_t i) { pressure[i] = static_cast<double>(x_phi_[i].w) / scale; });
}

void Pcisph::begin_step(StepState& state, const std::vector<double>& pressure) {
  OILSKIN_ASSERT(pressure.size() >= state.size() && state.velocity.size() == state.size() + 1);
  loop_.begin_step();
  walls_.begin_step(state);
  set_targets(state, fluid_.settings, target_);
  x_phi_ = state.position();
  predicted_.resize(state.size() + 1);
  predicted_[state.size()] = x_phi_.back();  // the padding
  const double warm_start = fluid_.warm_start(state);
  state.for_each([&](std::size_t i) { x_phi_[i].w = static_cast<float>(warm_start * pressure[i]); });
}

void Pcisph::iterate(StepState& state) {
  loop_.start({fluid_.settings.tolerance, fluid_.settings.min_iterations, {}});
  PressureLoop::Verdict verdict;
  do {
    predict_positions(state);
    verdict = loop_.judge(correct(state));
    if (!verdict.finite) state.for_each([&](std::size_t i) { x_phi_[i].w = 0; });
  } while (!verdict.stop);
}

/// x* = x + dt (v + dt a) under the current pressures, in units of H.
void Pcisph::predict_positions(StepState& state) {
  walls_.predict_walls(state, x_phi_);
  const double dt_over_h = state.dt / fluid_.support_radius;
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    ContactCursor contacts(state.contacts, begin);
    Record push[chunk_size];
    pair_kernels().pressure(pair_table(state, begin), x_phi_.data(), {begin, end}, push);
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 d = (to_vector(state.velocity[i]) + state.dv[i]) * dt_over_h - to_vector(push[i - begin]);
      walls_.constrain(state, i, x_phi_[i].w, contacts.of(i), d);
      const Record& x = x_phi_[i];
      predicted_[i] = {x.x + static_cast<float>(d[0]), x.y + static_cast<float>(d[1]),
                       x.z + static_cast<float>(d[2]), 0};
    }
  });
}

/// φ ← max(0, φ + ω τ_i (e_i − ē_i)) (F.27). The clamp belongs inside the loop, or free surfaces contract.
Errors Pcisph::correct(StepState& state) {
  const float step = static_cast<float>(loop_.relaxation() * fluid_.stiffness);
  const Errors result = state.ordered_sum(Errors{}, [&](std::size_t begin, std::size_t end) {
    Errors errors;
    float of_neighbours[chunk_size];
    pair_kernels().density(pair_table(state, begin), predicted_.data(), {begin, end}, of_neighbours);
    for (std::size_t i = begin; i < end; ++i) {
      const float own_mass = state.mass_ratio.empty() ? 1 : state.mass_ratio[i];
      float density = own_mass * fluid_.self_density + fluid_.density_scale * of_neighbours[i - begin];
      const std::uint32_t k = state.wall_point_of(i);
      if (k != Boundary::none) density += walls_.density(k);
      // Γ of the modes (F.21) is proportional to the square of the number density: so ω τ decreases with it.
      const float compressed = std::max(1.0f, state.relative_density[i]);
      const float own_step = step / (compressed * compressed);
      const float error = density - 1 - target_[i];
      float& phi = x_phi_[i].w;
      if (k == Boundary::none)
        phi = std::max(0.0f, phi + own_step * error);
      else
        walls_.collect(
            k, phi > 0 || error > 0 ? step_at_walls(fluid_, state.boundary.points()[k], own_step) : 0, error);
      errors.add(static_cast<double>(density) - 1, static_cast<double>(target_[i]),
                 fluid_.settings.tolerance);
    }
    return errors;
  });
  correct_at_walls(state);
  return result;
}

void Pcisph::correct_at_walls(StepState& state) {
  const std::vector<float>& change = walls_.solve(state);
  const std::vector<WallPoint>& points = state.boundary.points();
  state.workers.for_each(points.size(), chunk_size, [&](std::size_t k) {
    float& phi = x_phi_[points[k].particle].w;
    phi = std::max(0.0f, phi + change[k]);
  });
}

}  // namespace

std::unique_ptr<PressureModel> make_pcisph(const FluidSettings& settings) {
  return std::make_unique<Pcisph>(settings);
}

}  // namespace oilskin::fluid
