#include "study/comparators/particle_method.h"

#include <algorithm>
#include <cmath>

namespace oilskin::study {

ParticleMethod::ParticleMethod(const MethodSettings& settings, double particle_volume, double least_smoothing)
    : settings_(settings),
      volume_(particle_volume),
      support_(2 * settings.spacing),
      least_smoothing_(least_smoothing),
      xsph_rate_(settings.xsph_rate.value_or(default_xsph_rate(settings.spacing, settings.gravity.norm()))) {}

Status ParticleMethod::add_particles(Span<const Vec3> positions, Span<const Vec3> velocities) {
  if (positions.size() != velocities.size())
    return Status::refused("as many velocities as positions are needed");
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!positions[i].allFinite() || !velocities[i].allFinite())
      return Status::refused("positions and velocities must be finite");
  x_.insert(x_.end(), positions.begin(), positions.end());
  v_.insert(v_.end(), velocities.begin(), velocities.end());
  for (std::size_t i = 0; i < positions.size(); ++i) id_.push_back(next_id_++);
  density_.resize(x_.size(), settings_.rest_density);
  pressure_.resize(x_.size(), 0);
  return Status::accepted();
}

int ParticleMethod::intervals_of(double dt) const {
  double fastest2 = 0;
  for (const Vec3& v : v_) fastest2 = std::max(fastest2, v.squaredNorm());
  const double path = dt * (std::sqrt(fastest2) + dt * settings_.gravity.norm());
  const double limit = settings_.max_substeps.value_or(1);
  return static_cast<int>(std::clamp(std::ceil(path / settings_.spacing), 1.0, limit));
}

Status ParticleMethod::step(double dt) {
  if (!(dt > 0) || !std::isfinite(dt)) return Status::refused("dt must be > 0");
  Status gathered = surfaces_.gather(dt);
  if (!gathered.ok()) return gathered;
  const int intervals = intervals_of(dt);
  for (int k = 0; k < intervals; ++k) {
    before_ = x_;
    surfaces_.begin_interval(intervals - k);
    advance(dt / intervals);
    surfaces_.end_interval();
    if (observer_ != nullptr) {
      Interval interval;
      interval.length = dt / intervals;
      interval.id = id_;
      interval.x_t0 = before_;
      interval.x_t1 = x_;
      interval.surfaces = surfaces_.motions();
      observer_->on_interval(interval);
    }
    remove_outside();
  }
  surfaces_.scatter();
  return Status::accepted();
}

void ParticleMethod::remove_outside() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (!x_[i].allFinite() || !v_[i].allFinite() || !settings_.kill_box.contains(x_[i])) continue;
    id_[kept] = id_[i], x_[kept] = x_[i], v_[kept] = v_[i];
    density_[kept] = density_[i], pressure_[kept] = pressure_[i];
    ++kept;
  }
  id_.resize(kept), x_.resize(kept), v_.resize(kept), density_.resize(kept), pressure_.resize(kept);
}

void ParticleMethod::smooth(const NeighbourLists& lists, Span<const Vec3> x, double dt) {
  const double part = std::max(least_smoothing_, 1 - std::exp(-xsph_rate_ * dt));
  // Explicit: beyond this a pair would change places in velocity space.
  const double nu = std::min(settings_.viscosity, 0.035 * support_ * support_ / dt);
  change_.assign(x_.size(), Vec3::Zero());
  for (std::size_t i = 0; i < x_.size(); ++i)
    for (std::uint32_t j : lists.of(i)) {
      const double r = (x[i] - x[j]).norm();
      const double viscous = -2 * dt * nu * cubic_spline_slope(r, support_);
      change_[i] += volume_ * (part * cubic_spline(r, support_) + viscous) * (v_[j] - v_[i]);
    }
  for (std::size_t i = 0; i < x_.size(); ++i) v_[i] += change_[i];
}

}  // namespace oilskin::study
