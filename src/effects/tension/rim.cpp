#include "effects/tension/rim.h"

#include "effects/tension/tension_model.h"

namespace oilskin::effects {

namespace {

/// A barycentric coordinate below it is 0: walls have them in single precision.
constexpr double no_weight = 1e-6;

const Vec3& node(const EffectForces& f, const VisibleWall& wall, int corner) {
  return f.surfaces[wall.surface]->x_t0[wall.nodes[static_cast<std::size_t>(corner)]];
}

Vec3 closest_point(const EffectForces& f, const VisibleWall& wall) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) sum += wall.weights[static_cast<std::size_t>(k)] * node(f, wall, k);
  return sum;
}

}  // namespace

Rim::Rim(const EffectForces& f, std::size_t particle) {
  double shares = 0;
  for (const VisibleWall& w : f.walls(particle)) shares += w.share;
  const double missing = part_of_rim(shares);
  if (missing == 0) return;
  for (const VisibleWall& w : f.walls(particle)) {
    const Vec3 away = f.position[particle] - closest_point(f, w);
    const double d = away.norm();
    if (!(d > 0) || (wall && d >= distance)) continue;
    wall = &w;
    distance = d;
    normal = away / d;
  }
  if (!wall) return;
  part = missing;
  int last = -1;
  for (int k = 0; k < 3; ++k) {
    if (wall->weights[static_cast<std::size_t>(k)] <= no_weight) continue;
    if (++corners_ == 2) edge_ = (node(f, *wall, k) - node(f, *wall, last)).normalized();
    last = k;
  }
}

Vec3 Rim::turning(const Vec3& vector) const {
  if (corners_ == 3) return Vec3::Zero();
  const Vec3 tangential = vector - normal.dot(vector) * normal;
  return corners_ == 2 ? Vec3(tangential - edge_.dot(tangential) * edge_) : tangential;
}

}  // namespace oilskin::effects
