#include "fluid/pressure/wall_response.h"

#include <algorithm>

#include "core/assert.h"
#include "fluid/pressure/contact_bounds.h"
#include "fluid/stability.h"

namespace oilskin::fluid {

namespace {

/// Speed at which a wall may push compressed fluid off [m/s per relative compression] (B.30).
constexpr double wall_recovery_speed = 0.1;

/// Acceleration at which it may push fluid off [g] (B.30). Water that collapses and spreads under its weight
/// is pushed off floors with accelerations of this order, a jet of 2.5 m/s with hundreds of g.
constexpr double wall_acceleration = 1;

constexpr std::size_t point_chunk = 256;

}  // namespace

void WallResponse::begin_step(const StepState& state) {
  const FluidSettings& s = fluid_.settings;
  phi_per_depth_ = static_cast<float>(s.rest_density * state.gravity.norm() * fluid_.support_radius *
                                      fluid_.phi_per_pascal(state.dt));
  const std::size_t points = state.boundary.points().size();
  for (std::vector<float>* of_points : {&theta_, &step_, &change_}) of_points->resize(points);
  density_.assign(points, 0);
}

/// In units of φ. The weight of the fluid between particle and wall counts up to the pressure of the particle
/// (B.16): a drop is carried by contact.
template <class T>
WallLoad<T> WallResponse::load_on_walls(const WallPoint& point, T phi) const {
  const auto max_depth = static_cast<T>(point.max_depth), per_depth = static_cast<T>(phi_per_depth_);
  return {phi, per_depth * max_depth < phi ? per_depth : max_depth > 0 ? phi / max_depth : 0};
}

void WallResponse::predict_walls(StepState& state, Pressures phi) {
  if (state.boundary.empty()) return;
  const float per_phi = fluid_.wall_scale * static_cast<float>(fluid_.support_radius / state.dt);
  const std::vector<WallPoint>& points = state.boundary.points();
  OILSKIN_ASSERT(theta_.size() == points.size());
  state.workers.for_each(points.size(), point_chunk,
                         [&](std::size_t k) { theta_[k] = per_phi * phi[points[k].particle]; });
  depth_.clear();
  if (state.boundary.has_bodies()) {
    depth_.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
      depth_[k] = per_phi * load_on_walls(points[k], phi[points[k].particle]).per_depth;
  }
  for (std::vector<float>* pressure : {&theta_, &depth_})
    if (!state.mass_ratio.empty())
      for (std::size_t k = 0; k < pressure->size(); ++k)
        (*pressure)[k] *= state.mass_ratio[points[k].particle];
  state.boundary.compliance().predict_wall_velocity(theta_, depth_, state.workers);
}

void WallResponse::constrain_at(const StepState& state, std::uint32_t k, float phi,
                                Span<const PredictionContact> contacts, Vec3& displacement) {
  const double dt_over_h = state.dt / fluid_.support_radius;
  if (k == Boundary::none) return keep_side(contacts, dt_over_h, displacement);
  const WallPoint& point = state.boundary.points()[k];
  displacement +=
      (fluid_.wall_scale * point.velocity_change(load_on_walls(point, phi))).template cast<double>();
  keep_side(contacts, dt_over_h, displacement);
  const float approach = static_cast<float>(dt_over_h) * state.boundary.normal_flux()[k] -
                         point.gamma.dot(displacement.cast<float>());
  const float density = point.lambda + approach;
  density_[k] = wall_density_ == WallDensity::linear ? density : std::clamp(density, 0.0f, 1.0f);
}

const std::vector<float>& WallResponse::solve(StepState& state) {
  if (!state.boundary.empty())
    state.boundary.compliance().solve(fluid_.wall_scale, step_, change_, state.workers);
  return change_;
}

/// (B.13), with θ_T from the pressures φ; the load is limited by (B.29).
void WallResponse::apply(StepState& state, Pressures phi) {
  if (state.boundary.empty()) return;
  const double per_phi = static_cast<double>(fluid_.wall_scale) * fluid_.support_radius / state.dt;
  const std::vector<WallPoint>& points = state.boundary.points();
  load_.resize(points.size());
  state.workers.for_each(points.size(), point_chunk, [&](std::size_t k) {
    const auto load = load_on_walls(points[k], static_cast<double>(phi[points[k].particle])).times(per_phi);
    load_[k] = load.times(rebound_limit(state, k, load));
  });
  state.boundary.apply_load(load_, state.mass_ratio, state.dv, state.workers);
}

/// The factor (B.30) that makes the impulse of a wall inelastic: it removes the approach velocity, but adds
/// no rebound beyond `allowed`. The water that a jet spreads on a sheet is a layer or less, whose particles
/// push each other off the wall: without the limit 6 % of the jet's momentum came back, at any spacing.
double WallResponse::rebound_limit(const StepState& state, std::size_t k,
                                   const WallLoad<double>& load) const {
  const WallPoint& point = state.boundary.points()[k];
  const double gamma = static_cast<double>(point.gamma.norm());
  if (!(gamma > 0)) return 1;
  const Vec3 normal = point.gamma.cast<double>() / gamma;
  const double push =
      load.at_particle * gamma + load.per_depth * normal.dot(point.depth_gamma.cast<double>());
  if (!(push > 0)) return 1;
  const Record& v = state.velocity[point.particle];
  const double before =
      normal.dot(Vec3(v.x, v.y, v.z)) - static_cast<double>(state.boundary.normal_flux()[k]) / gamma;
  const double after = before + normal.dot(state.dv[point.particle]) + push;
  const double excess = std::max(0.0, static_cast<double>(state.relative_density[point.particle]) - 1);
  const double g = state.gravity.norm();
  const double allowed =
      std::max(0.0, before) + wall_acceleration * state.dt * g + wall_recovery_speed * metre(g) * excess;
  return std::clamp(1 - (after - allowed) / push, 0.0, 1.0);
}

}  // namespace oilskin::fluid
