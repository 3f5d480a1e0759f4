#include "fluid/pressure/density_shift.h"

#include <cmath>
#include <limits>

#include "core/assert.h"
#include "fluid/pressure/contact_bounds.h"
#include "fluid/pressure/momentum.h"
#include "fluid/pressure/wall_response.h"

namespace oilskin::fluid {

namespace {

/// Time in which a density error falls to 1/e, over √(dx/|g|) (F.60): speeds of the shift stay far below
/// those of waves of the length dx. Without gravity the constant of 5 mm under 9.81 m/s² per spacing is used.
constexpr double correction_time = 0.9;
constexpr double time_per_spacing = 4;  // [s/m]

/// No shift is longer, in spacings.
constexpr double max_shift = 0.2;

constexpr int max_iterations = 20;
constexpr float free_bound = -1e30f;

double time_constant(const StepState& state, double spacing) {
  const double g = state.gravity.norm(), by_spacing = time_per_spacing * spacing;
  return g > 0 ? std::min(correction_time * std::sqrt(spacing / g), 10 * by_spacing) : by_spacing;
}

}  // namespace

void DensityShift::find(StepState& state, FluidReport& report) {
  begin(state);
  const double tolerance = (1 - remaining_) * fluid_.settings.tolerance;
  Errors errors, first;
  int k = 0;
  for (; k < max_iterations; ++k) {
    displace(state);
    errors = correct(state);
    const double mean = errors.mean(errors.above_target);
    if (k == 0) first = errors;
    if (mean <= tolerance) break;
    if (!(mean <= 2 * first.mean(first.above_target))) {  // none is better than one that makes it worse
      std::fill(phi_.begin(), phi_.end(), 0.0f);
      errors = first;
      break;
    }
  }
  report.divergence_iterations = k;
  report.density_error_mean = errors.mean(errors.sum);
  report.density_error_max = errors.largest;
  limit(state);
}

void DensityShift::begin(const StepState& state) {
  const std::size_t n = state.size();
  drift_.resize(n);
  target_.resize(n);
  min_phi_.resize(n);
  phi_.assign(n + 1, 0);
  previous_phi_.assign(n, 0);
  displacement_.resize(n + 1);
  displacement_[n] = Record{0, 0, 0, 0};
  corrections_ = 0;
  remaining_ = std::exp(-state.dt / time_constant(state, fluid_.settings.spacing));
  const double dt_over_h = state.dt / fluid_.support_radius;
  state.for_each([&](std::size_t i) {
    const Record& v = state.velocity[i];
    drift_[i] = dt_over_h * (Vec3(v.x, v.y, v.z) + state.dv[i]);
    const float error = state.relative_density[i] - 1;
    const bool is_inside = error > -gap_density;
    min_phi_[i] = is_inside ? free_bound : 0;
    target_[i] = is_inside ? static_cast<float>(remaining_) * error : 0;
  });
}

/// −Σ (φ_i + φ_j) w'/q Δ + φ γ/D: walls count as prescribed.
Vec3 DensityShift::shift(const StepState& state, std::size_t i) const {
  Vec3 u = pair_displacement<F4>(state, phi_, i);
  const std::uint32_t k = WallResponse::point_of(state, i);
  if (k != Boundary::none)
    u += (fluid_.wall_scale * phi_[i] * state.boundary.points()[k].gamma).cast<double>();
  return u;
}

void DensityShift::displace(const StepState& state) {
  state.for_each([&](std::size_t i) { displacement_[i] = to_record(drift_[i] + shift(state, i)); });
}

/// Relative, of the linear prediction (F.32).
float DensityShift::density(const StepState& state, std::size_t i) const {
  float rho = state.relative_density[i] + fluid_.density_scale * pair_compression(state, displacement_, i);
  const std::uint32_t k = WallResponse::point_of(state, i);
  if (k == Boundary::none) return rho;
  const Record& y = displacement_[i];
  rho += static_cast<float>(state.dt / fluid_.support_radius) * state.boundary.normal_flux()[k];
  return rho - state.boundary.points()[k].gamma.dot(Eigen::Vector3f(y.x, y.y, y.z));
}

/// ω τ_i (F.30).
float DensityShift::step(const StepState& state, std::size_t i) const {
  const Record& g = state.gradient[i];
  const float scale = fluid_.density_scale;
  const float response =
      density_response(fluid_, state, i, scale * Eigen::Vector3f(g.x, g.y, g.z), scale * g.w);
  return static_cast<float>(fluid_.max_relaxation) *
         density_step(fluid_, state.relative_density[i], response);
}

Errors DensityShift::correct(const StepState& state) {
  const Momentum momentum(corrections_++);
  return state.ordered_sum(Errors{}, [&](std::size_t begin, std::size_t end) {
    Errors errors;
    for (std::size_t i = begin; i < end; ++i) {
      const float rho = density(state, i), error = rho - 1 - target_[i];
      const bool is_inside = min_phi_[i] < 0;
      const double excess = static_cast<double>(is_inside ? std::abs(error) : std::max(error, 0.0f));
      errors.add_residual(static_cast<double>(rho) - 1, excess);
      const float old = phi_[i];
      phi_[i] = std::max(min_phi_[i], momentum.next(old, previous_phi_[i], step(state, i) * error));
      previous_phi_[i] = old;
    }
    return errors;
  });
}

/// No shift is long, and none goes into a sheet. Where the velocity alone violates the bound of a contact the
/// shift has no normal part: it would hide the approach from contact, which stops it.
void DensityShift::limit(StepState& state) const {
  const double dt_over_h = state.dt / fluid_.support_radius;
  const double longest = max_shift * fluid_.settings.spacing;
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    ContactCursor contacts(state.contacts, begin);
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 u = shift(state, i);
      for (const PredictionContact& c : contacts.of(i)) {
        const double room = drift_[i].dot(c.normal) - c.min_normal_velocity * dt_over_h;
        const double along = u.dot(c.normal);
        u -= (room < 0 ? along : std::min(0.0, along + room)) * c.normal;
      }
      u *= fluid_.support_radius;
      const double length = u.norm();
      if (!std::isfinite(length)) u.setZero();
      if (length > longest) u *= longest / length;
      state.shift[i] = u;
    }
  });
}

}  // namespace oilskin::fluid
