#include "fluid/pressure/incompressible.h"

#include "core/assert.h"
#include "fluid/lattice.h"

namespace oilskin::fluid {

namespace {

using Kernel = CubicSpline;

/// A start that is compressed by more than this is not asked to be incompressible at the end of the step:
/// within one dt that means speeds of dx/dt, an explosion. The excess decays with the time constant instead.
constexpr float tolerated_compression = 0.05f;
constexpr double recovery_time = 0.002;  // [s]

/// Nor is the compression that the last step's tolerance left corrected faster than in this time [s] per
/// spacing [m]: within a millionth of a step that would throw resting water apart. With boundary terms it
/// takes longer, as contact does not stop what such corrections throw about: within 0.2 ms a jet of 5 mm
/// particles came off a plate with 15 % of its momentum where steps were short, within 1 ms as little as with
/// long ones.
constexpr double min_correction_time = 0.04, correction_time_at_walls = 0.2;

/// How fast a wall may push away what is compressed [m/s per relative compression].
constexpr double wall_recovery_speed = 0.1;

/// How fast it may make water leave besides [g]: water that collapses and spreads under its weight is pushed
/// off floors with accelerations of this order, a jet of 2.5 m/s with hundreds.
constexpr double wall_acceleration = 1;

/// How slowly iterations fall: by one, or by this ratio, after so many steps in which the fewer iterations
/// would have left no more than this part of the tolerance.
constexpr double max_fall = 1.18;
constexpr int min_settled_steps = 3;
constexpr double margin = 0.8;

/// Room that a particle takes when the water has settled, over its room on the lattice, at the same density:
/// what settles is disordered. Measured as the height of columns of 20 layers, 14 particles across. (At H = 2
/// dx columns 10 across are 0.4 % lower, wide basins 0.2 % higher, since the layers on walls pack closer:
/// these are means. Far from walls it is 0.9976, about that of closest spheres, 0.9975.)
struct Settled {
  double ratio, volume;
};
constexpr Settled settled[] = {{1.6, 1.027}, {1.8, 1.001}, {2, 0.994}, {2.2, 0.989}, {2.5, 0.978}};

double settled_volume(double ratio) {
  if (ratio <= settled[0].ratio) return settled[0].volume;
  for (std::size_t k = 1; k < std::size(settled); ++k) {
    const Settled &a = settled[k - 1], &b = settled[k];
    if (ratio < b.ratio) return a.volume + (b.volume - a.volume) * (ratio - a.ratio) / (b.ratio - a.ratio);
  }
  return std::end(settled)[-1].volume;
}

/// How ω rises again, per step. What made it fall, an impact or a start out of order, passes, and one of
/// 1/256 solves nothing any more.
constexpr double relaxation_rise = 1.02;

}  // namespace

IncompressibleSums::IncompressibleSums(double volume, double support_radius, double smoothed_fraction,
                                       double viscosity_dt, const ViscousWeights& weights)
    : DensityModel(volume, support_radius, smoothed_fraction),
      by_slope(static_cast<float>(2 * viscosity_dt / (support_radius * support_radius) * weights.slope)),
      by_hat(static_cast<float>(2 * viscosity_dt / (support_radius * support_radius) * weights.hat)) {}

/// δ and ω belong to the lattice on which particles of volume V pack: its spacing is V^(1/3) (a lattice that
/// is 8 % wider gives a δ 1.4 times too large, and the loop diverges).
IncompressibleModel::IncompressibleModel(const FluidSettings& s)
    : settings_(s),
      support_radius_(s.support_ratio * s.spacing),
      volume_(std::pow(s.spacing, 3) / lattice_density<Kernel>(s.support_ratio)),
      settled_volume_(settled_volume(s.support_ratio) * volume_),
      viscous_weights_(viscous_weights<Kernel>(s.support_ratio)) {
  const double packing = std::cbrt(volume_), ratio = support_radius_ / packing;
  const double scale = volume_ * Kernel::norm / std::pow(support_radius_, 3);
  density_scale_ = static_cast<float>(scale);
  self_density_ = density_scale_ * static_cast<float>(Kernel::w(0.0));
  stiffness_ = scale * pcisph_stiffness<Kernel>(ratio) / (ratio * ratio);
  full_relaxation_ = relaxation_ = pcisph_relaxation<Kernel>(ratio);
  OILSKIN_ASSERT(volume_ > 0 && stiffness_ > 0 && relaxation_ > 0 && relaxation_ <= 1);
  push_scale_ = 1 / density_scale_;
}

void IncompressibleModel::visit(Archive& archive) {
  archive.value(relaxation_);
  archive.require(relaxation_ > 0 && relaxation_ <= full_relaxation_, "the relaxation of the pressure");
}

void IncompressibleModel::IterationController::visit(Archive& archive) {
  archive.values(iterations, settled_steps);
  archive.require(iterations >= 0 && settled_steps >= 0, "the number of iterations");
}

IncompressibleSums IncompressibleModel::sums(double dt) const {
  return {volume_, support_radius_, -std::expm1(-settings_.xsph_rate * dt), settings_.viscosity * dt,
          viscous_weights_};
}

double IncompressibleModel::phi_per_pascal(double dt) const {
  const double forces_over_masses = volume_ / settled_volume_;
  return forces_over_masses * dt * dt * static_cast<double>(density_scale_) /
         (settings_.rest_density * support_radius_ * support_radius_);
}

/// A step that iterates more than it must leaves the next ones little to do; those then iterate too little,
/// and the pressures swing between the two. So iterations fall slowly, and only where the tolerance would
/// have been met with fewer for some time: the error goes as their inverse square.
bool IncompressibleModel::PressureLoop::may_end(double mean) {
  if (!converged || iterations < min_iterations) return false;
  if (iterations >= controller.iterations) return true;
  const double ratio = static_cast<double>(controller.iterations) / iterations;
  if (iterations + 1 < controller.iterations && ratio > max_fall) return false;
  if (ratio * ratio * mean <= margin * tolerance) fewer_would_do = true;
  return fewer_would_do && controller.settled_steps >= min_settled_steps;
}

IncompressibleModel::IterationController IncompressibleModel::PressureLoop::next_controller() const {
  const bool fell = iterations < controller.iterations;
  return {iterations, fewer_would_do && !fell ? controller.settled_steps + 1 : 0};
}

void IncompressibleModel::begin(StepState& state) {
  const float remaining = static_cast<float>(std::exp(-state.dt / recovery_time));
  const double per_spacing = state.boundary.empty() ? min_correction_time : correction_time_at_walls;
  const float left = static_cast<float>(std::max(0.0, 1 - state.dt / (per_spacing * settings_.spacing)));
  OILSKIN_ASSERT(state.relative_density.size() == state.size() && state.dv.size() == state.size());
  relaxation_ = std::min(relaxation_rise * relaxation_, full_relaxation_);
  phi_per_depth_ = static_cast<float>(settings_.rest_density * state.gravity.norm() * support_radius_ *
                                      phi_per_pascal(state.dt));
  const std::size_t points = state.boundary.points().size();
  for (std::vector<float>* of_points : {&theta_, &wall_step_, &wall_change_}) of_points->resize(points);
  wall_density_.assign(points, 0);
  drift_.resize(state.size());
  target_.resize(state.size());
  state.for_each([&](std::size_t i) {
    const float excess = std::max(0.0f, state.relative_density[i] - 1);
    target_[i] = remaining * std::max(0.0f, excess - tolerated_compression) +
                 left * std::min(excess, tolerated_compression);
  });
}

/// p = ½ p_old (dt_old/dt)², so that the displacement by pressure starts at half of what it was. More than
/// half makes the slow modes of a column at rest grow from step to step. After a longer step the pressure is
/// kept, not the displacement: within a millionth of the time that would throw water apart.
double IncompressibleModel::warm_start(const StepState& state) const {
  OILSKIN_ASSERT(state.previous_dt >= 0 && state.dt > 0);
  const double ratio = std::min(1.0, state.previous_dt / state.dt);
  return 0.5 * ratio * ratio * phi_per_pascal(state.dt);
}

void IncompressibleModel::write(const PressureLoop& density, FluidReport& report) {
  report.iterations = density.iterations;
  report.density_error_mean = density.errors.mean(density.errors.sum);
  report.density_error_max = density.errors.largest;
  report.converged = density.converged;
  report.diverged |= density.diverged;
}

/// Removes what approaches a sheet beyond the bound, one contact after the other; twice, since the later may
/// undo the earlier in a corner.
void IncompressibleModel::keep_side(const StepState& state, Span<const PredictionContact> contacts,
                                    Vec3& displacement) const {
  const double to_displacement = state.dt / support_radius_;
  for (int pass = 0; pass < (contacts.size() > 1 ? 2 : 1); ++pass)
    for (const PredictionContact& c : contacts) {
      const double short_of = c.min_normal_velocity * to_displacement - displacement.dot(c.normal);
      if (short_of > 0) displacement += short_of * c.normal;
    }
}

/// The pressure of a wall stops what comes; what it would throw back it does not push, as contact would not.
/// The water that a jet spreads on a sheet is a layer or less, whose particles drive each other off the wall
/// where they meet: without this 6 % of the jet's momentum came back, whatever the spacing. Where the water
/// is compressed the wall may push it off, slowly. Returns the share of the load that remains.
double IncompressibleModel::rebound_limit(const StepState& state, std::size_t k,
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
  const double allowed = std::max(0.0, before) + wall_acceleration * state.dt * state.gravity.norm() +
                         wall_recovery_speed * excess;
  return std::clamp(1 - (after - allowed) / push, 0.0, 1.0);
}

bool IncompressibleModel::diverges(double mean, double tolerance) {
  const bool far_above = mean > 10 * tolerance + 1e-3;
  growing_ = far_above && last_mean_ > 0 && mean > last_mean_ ? growing_ + 1 : 0;
  last_mean_ = mean;
  return growing_ >= 3;
}

}  // namespace oilskin::fluid
