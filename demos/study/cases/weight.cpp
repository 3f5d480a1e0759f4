/// A column of water at rest in a tank: weight, level, pressure, calm.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double width = 0.06, depth = 0.1;  // [m]
constexpr double settled = 0.7;              // [s]

class Column : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (now.t < settled) {
      momentum_ = fluid_momentum(now.simulation.world()).y();
      return;
    }
    const World& world = now.simulation.world();
    depth_ = world.fluid_mass() / (water_density * width * width);
    force_.add(-impulse_on(now.simulation.body(0)).y() / now.dt, now.dt);
    height_.add(2 * mean_position(world).y() / depth_, now.dt);
    speed_ = std::max(speed_, largest_speed(world));
    for (std::size_t i = 0; i < world.particle_count(); ++i) look(world, i);
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const World& world = end.simulation.world();
    // What the column's own momentum still changes does not press on the floor.
    const double gained = (fluid_momentum(world).y() - momentum_) / (end.t - settled);
    const double weight = world.fluid_mass() * earth;
    return {{"force / weight", (force_.value() - gained) / weight, 1, 0, 0, 0.002},
            {"height / depth", height_.value(), 1, 0, 0, 0.01, 1},
            {"pressure, rms error / largest", std::sqrt(squares_ / count_), 0, 1, 0, 0.03, 1},
            {"pressure of the first layer / exact", first_ / first_exact_, 1, 0, 0, 0.03, 1},
            {"largest speed [m/s]", speed_, 0, 1, 0, 0.05}};
  }

 private:
  void look(const World& world, std::size_t i) {
    const double spacing = world.fluid_settings().spacing, y = world.positions()[i].y(),
                 exact = water_density * earth * (depth_ - y), p = world.pressures()[i];
    if (y < spacing) {
      first_ += p;
      first_exact_ += exact;
    }
    if (y < 2 * spacing || y > depth_ - 2 * spacing) return;
    const double off = (p - exact) / (water_density * earth * depth_);
    squares_ += off * off;
    count_ += 1;
  }

  TimeMean force_, height_;  // [N], relative
  double depth_ = depth;     // of that mass of water; a lattice may not fill the box [m]
  double momentum_ = 0, speed_ = 0, first_ = 0, first_exact_ = 0, squares_ = 0, count_ = 0;
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 1.2);
  scene.emitters = {water_box(Vec3::Zero(), Vec3(width, depth, width))};
  scene.bodies = {tank_body(Vec3::Zero(), Vec3(width, 2 * depth, width))};
  return scene;
}

}  // namespace

ValidationCase weight_case() {
  return {"weight",
          "column of 0.1 m at rest in a tank of 0.06 m",
          "hydrostatics; force: momentum balance",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Column>(); }};
}

}  // namespace oilskin::demo
