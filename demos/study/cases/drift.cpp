/// Water with random velocities in a closed box, without gravity.
#include <algorithm>
#include <cmath>
#include <random>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double edge = 0.08, block = 0.02;  // of the box, and of the water that shares a velocity [m]
constexpr double speed = 0.5;                // largest component of a block's velocity [m/s]

class Ledger : public Probe {
 public:
  void after_step(const Moment& now) override {
    const World& world = now.simulation.world();
    residual_ += world.report().momentum_residual();
    const double energy = kinetic_energy(world);
    if (first_ == 0) first_ = energy;
    rise_ = std::max(rise_, energy - least_);
    least_ = std::min(least_, energy);
    double volume = 0;
    for (const double density : world.densities()) volume += world.particle_mass() / density;
    const double rest = world.fluid_mass() / world.fluid_settings().rest_density;
    if (std::abs(volume / rest - 1) > std::abs(volume_ - 1)) volume_ = volume / rest;
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const double scale = end.simulation.world().fluid_mass() * speed;
    const auto steps = static_cast<double>(end.simulation.time().steps());
    return {{"momentum, residual per step / Σ m v", residual_.norm() / (scale * steps), 0, 1, 0, 1e-12},
            {"kinetic energy, largest rise / first", rise_ / first_, 0, 1, 0, 0.01},
            {"Σ m/ρ over the volume at rest, farthest", volume_, 1, 0, 0, 0.02}};
  }

 private:
  Vec3 residual_ = Vec3::Zero();                 // [N s]
  double first_ = 0, least_ = never, rise_ = 0;  // [J]
  double volume_ = 1;                            // over that at rest
};

/// The same numbers on every system: those of the standard library's distributions are not.
double random_component(std::mt19937& random) {
  return speed * (2 * (static_cast<double>(random()) / 4294967296.0) - 1);
}

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.4);
  scene.world.gravity.setZero();
  std::mt19937 random(1);
  const int n = static_cast<int>(std::lround(edge / block));
  for (int i = 0; i < n * n * n; ++i) {
    const int row = i / n % n, layer = i / (n * n);
    const Vec3 low = block * Vec3(i % n, row, layer);
    FilledBox water = water_box(low, low + Vec3::Constant(block));
    for (int axis = 0; axis < 3; ++axis) water.velocity[axis] = random_component(random);
    scene.emitters.emplace_back(water);
  }
  TankShape box;
  box.inside = {Vec3::Zero(), Vec3::Constant(edge)};
  box.open.setZero();
  scene.bodies.emplace_back().shape = box;
  return scene;
}

}  // namespace

ValidationCase drift_case() {
  return {"drift",
          "blocks of water with random velocities fill a closed box, no gravity",
          "conservation of momentum, energy and volume",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Ledger>(); }};
}

}  // namespace oilskin::demo
