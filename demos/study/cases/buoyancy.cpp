/// A fixed cube under water.
#include "study/cases/case_table.h"
#include "study/cases/parts.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double edge = 0.04, tank = 0.12;  // [m]
constexpr double settled = 0.8;             // [s]

class Lift : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (now.t < settled) return;
    const Vec3 force = impulse_on(now.simulation.body(1)) / now.dt;
    for (int axis = 0; axis < 3; ++axis) force_[axis].add(force[axis], now.dt);
  }

  std::vector<Quantity> quantities(const Moment&) override {
    const double exact = water_density * earth * edge * edge * edge;
    const double sideways = std::hypot(force_[0].value(), force_[2].value());
    // 1 % at 5 mm, which is 8 spacings an edge; the finest has 10.
    return {{"lift [N]", force_[1].value(), exact, 0, 0, 0.008, 1},
            {"sideways force / lift", sideways / exact, 0, 1, 0, 0.008, 1}};
  }

 private:
  TimeMean force_[3];  // on the cube [N]
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 1.4);
  const Vec3 low = Vec3::Zero(), high = Vec3::Constant(tank), middle = 0.5 * high;
  const Vec3 half = Vec3::Constant(0.5 * edge);
  scene.emitters = water_around({low, high}, {middle - half, middle + half});
  BoxShape cube;
  cube.center = middle;
  cube.half_extents = half;
  Body body;
  body.shape = cube;
  scene.bodies = {tank_body(low, Vec3(tank, 1.5 * tank, tank)), body};
  return scene;
}

}  // namespace

ValidationCase buoyancy_case() {
  return {"buoyancy",
          "fixed cube of 40 mm in the middle of a tank with 120 mm of water",
          "Archimedes' principle, F = ρ g V",
          {0.01, 0.005, 0.004},
          scene_at,
          [](const Scene&) { return std::make_unique<Lift>(); }};
}

}  // namespace oilskin::demo
