#include "study/cases/measures.h"

#include <algorithm>

#include "checks/node_mass.h"
#include "scene/scene.h"

namespace oilskin::demo {

double level_within(const World& world, const Box& within) {
  std::vector<double> heights;
  for (const Vec3& x : world.positions())
    if (within.contains(x)) heights.push_back(x.y());
  if (heights.empty()) return never;
  const auto at = static_cast<std::size_t>(0.98 * static_cast<double>(heights.size() - 1));
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(at), heights.end());
  return heights[at] + 0.5 * world.fluid_settings().spacing;
}

double mass_within(const World& world, const Box& within) {
  const Span<const Vec3> x = world.positions();
  const auto count = std::count_if(x.begin(), x.end(), [&](const Vec3& p) { return within.contains(p); });
  return static_cast<double>(count) * world.particle_mass();
}

double depth_of(const World& world, double mass, double area) {
  return mass / (world.fluid_settings().rest_density * area);
}

Vec3 free_momentum(const SurfaceMotion& motion) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < motion.velocity.size(); ++i)
    if (motion.inverse_mass[i] > 0) sum += node_mass(motion, i) * motion.velocity[i];
  return sum;
}

double free_mass(const SurfaceMotion& motion) {
  double sum = 0;
  for (std::size_t i = 0; i < motion.inverse_mass.size(); ++i)
    if (motion.inverse_mass[i] > 0) sum += node_mass(motion, i);
  return sum;
}

}  // namespace oilskin::demo
