/// A vortex in a square tank without friction at its walls: its energy decays by viscosity alone.
/// Gravity keeps the pressure of the water positive: it holds no tension.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double side = 0.1, depth = 0.04;       // [m]
constexpr double speed = 0.3, viscosity = 5e-3;  // of the fastest water [m/s], [m²/s]
constexpr double begin = 0.02, duration = 0.12;  // [s]: the first steps settle the lattice

class Decay : public Probe {
 public:
  void after_step(const Moment& now) override {
    const double amplitude = projection(now.simulation.world());
    if (start_ == 0 && now.t >= begin) {
      start_ = amplitude;
      from_ = now.t;
    }
    end_ = amplitude;
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const double k = M_PI / side, exact = 2 * k * k * viscosity;
    const double rate = std::log(start_ / end_) / (end.t - from_);
    return {{"rate of decay / (2 k² ν)", rate / exact, 1, 0, 0, 0.1, 1},
            {"amplitude at the end / exact", end_ / (speed * std::exp(-exact * end.t)), 1, 0, 0, 0.1, 1}};
  }

 private:
  /// Of the velocities onto the flow of the start.
  static double projection(const World& world) {
    double dot = 0, norm = 0;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const Vec3& x = world.positions()[i];
      const double a = M_PI * x.x() / side, b = M_PI * x.z() / side;
      const Vec3 flow(std::sin(a) * std::cos(b), 0, -std::cos(a) * std::sin(b));
      dot += flow.dot(world.velocities()[i]);
      norm += flow.squaredNorm();
    }
    return dot / norm;
  }

  double start_ = 0, from_ = 0, end_ = 0;
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, duration);
  scene.fluid.viscosity = viscosity;
  scene.fluid.xsph_rate = 0;
  scene.bodies = {tank_body(Vec3::Zero(), Vec3(side, 2 * depth, side))};
  FilledBox water = water_box(Vec3::Zero(), Vec3(side, depth, side));
  FieldTerm vortex;
  vortex.kind = FieldKind::taylor_green;
  vortex.edge_u = Vec3(side, 0, 0);
  vortex.edge_v = Vec3(0, 0, side);
  vortex.amplitude = speed;
  water.initial.flow = {vortex};
  scene.emitters = {water};
  return scene;
}

}  // namespace

ValidationCase taylor_green_case() {
  return {"taylor_green",
          "a vortex in a square tank decays by viscosity",
          "[Taylor1937]: exp(−2 k² ν t)",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Decay>(); }};
}

}  // namespace oilskin::demo
