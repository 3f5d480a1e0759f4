#include "effects/forces/exposure.h"

#include <algorithm>
#include <cmath>

#include "fluid/kernels.h"

namespace oilskin::effects {

namespace {

/// w of (G.3), with the distance in spacings: a neighbour at up to 1.2 dx shelters fully, one at 2 dx not.
double nearness(double distance) {
  return std::clamp((2 - distance) / 0.8, 0.0, 1.0);
}

/// Of water on one side, as a lattice has it; and what leaves nothing exposed, so that disorder does not.
constexpr double shelter_of_water = 2.9, full_shelter = 2;

double squared(double x) {
  return x * x;
}

}  // namespace

/// (G.3)
double exposed_part(const EffectForces& f, std::size_t i, const Vec3& side) {
  double shelter = 0;
  for (std::uint32_t j : f.neighbours(i)) {
    const Vec3 d = f.position[j] - f.position[i];
    const double along = d.dot(side), distance = d.norm();
    if (along > 0) shelter += nearness(distance / f.spacing) * squared(along / distance);
  }
  for (const VisibleWall& wall : f.walls(i))
    shelter += shelter_of_water * wall.share * squared(std::max(0.0, -wall.normal.dot(side)));
  return std::max(0.0, 1 - shelter / full_shelter);
}

/// (G.4)
Vec3 outward_slope(const EffectForces& f, std::size_t i) {
  using Kernel = fluid::WendlandC2;
  const double h = f.support_radius;
  Vec3 slope = Vec3::Zero();
  for (std::uint32_t j : f.neighbours(i)) {
    const Vec3 d = (f.position[i] - f.position[j]) / h;
    slope -= Kernel::norm * Kernel::dw_over_q(d.norm()) * f.mass(j) / (f.rest_density * h * h * h) * d;
  }
  for (const VisibleWall& wall : f.walls(i))
    slope += wall.share * Kernel::plane(wall.distance / h) * wall.normal;
  return slope;
}

/// (G.5)
Exposure exposure(const EffectForces& f, std::size_t i, const Vec3& wind) {
  const double volume = f.mass(i) / f.rest_density;
  const double section = std::cbrt(volume * volume);
  const Vec3 slope = outward_slope(f, i);
  const double size = slope.norm();
  const double part = std::clamp((size - no_surface) / (clear_surface - no_surface), 0.0, 1.0);
  Exposure area;
  if (part > 0) {
    area.whole = part * section * exposed_part(f, i, slope / size);
    area.facing = area.whole * std::max(0.0, -slope.dot(wind) / size);
  }
  if (part < 1) {
    const double loose = (1 - part) * section * exposed_part(f, i, -wind);
    area.whole += loose;
    area.facing += loose;
  }
  return area;
}

}  // namespace oilskin::effects
