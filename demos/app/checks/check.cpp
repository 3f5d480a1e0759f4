#include "checks/check.h"

#include <limits>

#include "geometry/pool.h"

namespace oilskin::demo {

CheckResult at_most(const std::string& name, double value, double limit) {
  return {name, value, limit, value <= limit};
}

CheckResult at_least(const std::string& name, double value, double limit) {
  return {name, value, limit, value >= limit};
}

double ratio(double a, double b) {
  return b > 0 ? a / b : (a > 0 ? std::numeric_limits<double>::infinity() : 0);
}

Vec3 up_of(const Scene& scene) {
  const Vec3& g = scene.world.gravity;
  return g.norm() > 0 ? Vec3(-g.normalized()) : Vec3(0, 1, 0);
}

double water_volume(const Scene& scene, Simulation& simulation) {
  return simulation.world().fluid_mass() / scene.fluid.rest_density;
}

double kinetic_energy(const World& world) {
  return world.particle_mass() * kinetic_energy_per_mass(world.motions(), world.mass_ratios());
}

void check_cloth_index(const Scene& scene, int index, const std::string& key) {
  if (index < 0 || index >= static_cast<int>(scene.cloth.size()))
    throw SceneError(key + ": is " + std::to_string(index) +
                     ", must be the index of a cloth, the scene has " + std::to_string(scene.cloth.size()));
}

void check_has_weight(const Scene& scene) {
  if (!(scene.world.gravity.norm() > 0))
    throw SceneError("gravity: is zero; a pool or a dam break needs a weight");
}

}  // namespace oilskin::demo
