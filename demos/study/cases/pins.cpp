/// Water at rest in a basin of cloth.
#include "checks/pin_impulse.h"
#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double window = 1;  // mean over the last seconds

class Reaction : public Probe {
 public:
  void after_step(const Moment& now) override {
    pins_.after_step(now);
    if (!in_last(window, now)) return;
    force_.add(pins_.last().y() / now.dt, now.dt);
    weight_.add((pins_.free_mass() + now.simulation.world().fluid_mass()) * earth, now.dt);
  }

  std::vector<Quantity> quantities(const Moment&) override {
    return {{"reaction of the pins [N]", force_.value(), weight_.value(), 0, 0, 0.005}};
  }

 private:
  PinImpulse pins_;
  TimeMean force_, weight_;  // [N]
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 1.8);
  Cloth basin;
  basin.grid = {11, 11};
  basin.size = {0.25, 0.25};
  basin.bowl_depth = 0.08;
  basin.areal_density = 0.5;
  basin.pins.kind = PinKind::border;
  scene.cloth = {basin};
  scene.emitters = {water_box(Vec3(-0.05, -0.05, -0.05), Vec3(0.05, -0.01, 0.05))};
  return scene;
}

}  // namespace

ValidationCase pins_case() {
  return {"pins",
          "0.4 litres of water in a basin of cloth that is pinned at its border",
          "statics: the weight of cloth and water",
          {0.01, 0.00625, 0.005},
          scene_at,
          [](const Scene&) { return std::make_unique<Reaction>(); }};
}

}  // namespace oilskin::demo
