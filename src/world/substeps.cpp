#include "world/substeps.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"

namespace oilskin::world {

int substep_count(const Speeds& speeds, double dt, double distance, int maximum) {
  OILSKIN_ASSERT(dt > 0 && distance > 0 && maximum >= 1);
  const double fluid = speeds.fluid + speeds.gravity * dt;
  const double by_speed = std::ceil(dt * std::max(fluid, speeds.surfaces) / distance);
  const double by_change = parts_needed(dt, longest_step({speeds.fluid, speeds.change, 0, 0}, distance));
  const double parts = std::max(by_speed, by_change);
  return parts < maximum ? std::max(1, static_cast<int>(parts)) : maximum;
}

double parts_needed(double dt, double longest) {
  OILSKIN_ASSERT(dt > 0 && longest >= 0);
  return std::max(1.0, std::ceil(dt / longest * (1 - 1e-12)));
}

double longest_step(const Speeds& speeds, double distance) {
  OILSKIN_ASSERT(distance > 0 && speeds.fluid >= 0 && speeds.gravity >= 0 && speeds.surfaces >= 0);
  // The root of dt (v + g dt) = distance, in the form without cancellation.
  const double slope = speeds.fluid + std::sqrt(speeds.fluid * speeds.fluid + 4 * speeds.gravity * distance);
  double longest = std::numeric_limits<double>::infinity();
  if (slope > 0) longest = 2 * distance / slope;
  if (speeds.surfaces > 0) longest = std::min(longest, distance / speeds.surfaces);
  return longest;
}

double fastest_node(Span<SurfaceMotion* const> surfaces, const Box& water, double dt) {
  OILSKIN_ASSERT(dt > 0);
  double longest = 0;  // squared
  for (const SurfaceMotion* s : surfaces)
    for (const Triangle& t : s->triangles) {
      Box swept;
      double distance = 0;
      for (std::uint32_t node : t) {
        swept.add(s->x_t0[node]);
        swept.add(s->x_t1[node]);
        distance = std::max(distance, (s->x_t1[node] - s->x_t0[node]).squaredNorm());
      }
      if (distance > longest && swept.overlaps(water)) longest = distance;
    }
  return std::sqrt(longest) / dt;
}

void SurfacePaths::begin(Span<SurfaceMotion* const> surfaces, int parts, double length) {
  OILSKIN_ASSERT(parts >= 1 && length > 0);
  paths_.clear();
  parts_ = left_ = parts;
  length_ = length;
  if (parts == 1) return;
  for (SurfaceMotion* s : surfaces)
    paths_.push_back({s, s->x_t0, s->x_t1, s->velocity, std::vector<Vec3>(s->x_t0.size(), Vec3::Zero())});
}

void SurfacePaths::next() {
  OILSKIN_ASSERT(left_ > 0);
  for (Path& path : paths_) {
    if (left_ < parts_) continue_from_certified(path);
    SurfaceMotion& m = *path.motion;
    for (std::size_t i = 0; i < m.x_t0.size(); ++i)
      m.x_t1[i] =
          left_ == 1 ? path.target[i] : stored(m.x_t0[i] + (path.target[i] - m.x_t0[i]) / left_, m.storage);
  }
  --left_;
}

void SurfacePaths::continue_from_certified(Path& path) const {
  SurfaceMotion& m = *path.motion;
  OILSKIN_ASSERT(m.impulse.size() == m.x_t1.size() && path.target.size() == m.x_t1.size());
  m.x_t0 = m.x_t1;
  if (m.smooth) m.velocity_t0 = m.velocity;
  for (std::size_t i = 0; i < m.x_t0.size(); ++i) {
    path.impulse[i] += m.impulse[i];
    // A prescribed node that was held has a longer displacement in less time; its velocity is that.
    if (m.moved[i] && m.inverse_mass[i] == 0)
      m.velocity[i] = (path.target[i] - m.x_t0[i]) / (left_ * length_);
  }
}

void SurfacePaths::end() {
  OILSKIN_ASSERT(left_ == 0);
  for (Path& path : paths_) {
    SurfaceMotion& m = *path.motion;
    m.x_t0 = path.start;
    for (std::size_t i = 0; i < m.x_t0.size(); ++i) {
      m.impulse[i] += path.impulse[i];
      m.moved[i] = m.x_t1[i] != path.target[i];
      if (m.inverse_mass[i] == 0) m.velocity[i] = path.velocity[i];
    }
  }
}

}  // namespace oilskin::world
