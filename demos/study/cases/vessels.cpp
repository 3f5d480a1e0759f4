/// Communicating vessels.
#include "study/cases/case_table.h"
#include "study/cases/measures.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double length = 0.06, breadth = 0.03;  // of each vessel [m]
constexpr double left = 0.15, right = 0.11;      // depths at the start [m]
constexpr double gap = 0.06, top = 0.2;          // the wall between them begins and ends there [m]
constexpr double window = 0.2;                   // levels are means over the end of the run [s]
constexpr double damping_viscosity = 1e-3;       // [m²/s]

class Levels : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (!in_last(window, now)) return;
    const World& world = now.simulation.world();
    left_.add(level_within(world, {Vec3(-length, 0, 0), Vec3(0, top, breadth)}), now.dt);
    right_.add(level_within(world, {Vec3::Zero(), Vec3(length, top, breadth)}), now.dt);
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const World& world = end.simulation.world();
    const double depth = depth_of(world, world.fluid_mass(), 2 * length * breadth);
    const double spacing = world.fluid_settings().spacing;
    return {{"difference of levels / spacing", (left_.value() - right_.value()) / spacing, 0, 1, 0, 1},
            {"mean level [m]", 0.5 * (left_.value() + right_.value()), depth, 0, 0, 0.01, 1}};
  }

 private:
  TimeMean left_, right_;  // [m]
};

void add_walls(Scene& scene) {
  SlipSettings no_slip;
  no_slip.model = SlipModel::viscous_wall;
  scene.bodies = {tank_body(Vec3(-length, 0, 0), Vec3(length, top, breadth)),
                  mesh_body(sheet_mesh(Vec3(0, gap, 0), Vec3(0, top - gap, 0), Vec3(0, 0, breadth)))};
  for (Body& body : scene.bodies) body.surface.slip = no_slip;
}

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 1.5);
  scene.emitters = {water_box(Vec3(-length, 0, 0), Vec3(0, left, breadth)),
                    water_box(Vec3::Zero(), Vec3(length, right, breadth))};
  add_walls(scene);
  // The levels at rest do not depend on it; water would swing for many seconds.
  scene.fluid.viscosity = damping_viscosity;
  return scene;
}

}  // namespace

ValidationCase vessels_case() {
  return {"vessels",
          "water that starts 150 mm and 110 mm deep in vessels with a gap of 60 mm below their wall",
          "hydrostatics: equal levels; mean level from the volume of the water",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Levels>(); }};
}

}  // namespace oilskin::demo
