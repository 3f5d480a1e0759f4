/// Water leaves a tank through a slot in its wall.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/measures.h"
#include "study/cases/parts.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double length = 0.12, level = 0.2, breadth = 0.02;  // of the water at the start [m]
constexpr double slot_low = 0.05, slot = 0.02;                // [m]
constexpr double top = 0.25, apron = 0.08, bottom = -0.04;    // ends of the walls [m]
constexpr double settled = 0.15;                              // [s]
constexpr double pi = 3.14159265358979323846;

class Jet : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (now.t < settled) return;
    const World& world = now.simulation.world();
    const Box tank = {Vec3(-length, 0, 0), Vec3(0, top, breadth)};
    const double mass = mass_within(world, tank);
    if (first_mass_ == 0) {
      first_mass_ = mass;
      first_time_ = now.t;
    }
    last_mass_ = mass;
    look(world, level_within(world, tank), now.dt);
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const double flow = (first_mass_ - last_mass_) / (end.t - first_time_) / water_density;
    // The surface in the tank falls at a tenth of the jet's speed, which adds 0.5 %.
    return {{"speed of the jet [m/s]", speed_.value(), exact_.value(), 0, 0.005, 0.05},
            {"contraction of the jet", flow / (slot * breadth * speed_.value()), pi / (pi + 2), 0, 0, never}};
  }

 private:
  /// At one to two widths of the slot behind it, where the jet has contracted and is at the pressure of the
  /// air. Each particle has its own depth below the surface.
  void look(const World& world, double surface, double dt) {
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const Vec3& x = world.positions()[i];
      if (x.x() < slot || x.x() > 2 * slot) continue;
      speed_.add(world.motions()[i].norm(), dt);
      exact_.add(std::sqrt(2 * earth * (surface - x.y())), dt);
    }
  }

  TimeMean speed_, exact_;                                  // over particles and time [m/s]
  double first_mass_ = 0, last_mass_ = 0, first_time_ = 0;  // in the tank [kg], [s]
};

void add_walls(Scene& scene) {
  const double slot_high = slot_low + slot;
  for (const std::vector<Point2>& line :
       {std::vector<Point2>{{-length, top}, {-length, 0}, {0, 0}, {0, slot_low}},
        std::vector<Point2>{{0, slot_high}, {0, top}}})
    scene.bodies.push_back(mesh_body(swept_sheet(line, 0, breadth, 1)));
  for (const double z : {0.0, breadth})
    scene.bodies.push_back(mesh_body(
        sheet_mesh(Vec3(-length, bottom, z), Vec3(length + apron, 0, 0), Vec3(0, top - bottom, 0))));
}

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.3);
  scene.emitters = {water_box(Vec3(-length, 0, 0), Vec3(0, level, breadth))};
  add_walls(scene);
  // What has passed the place of the measurement leaves.
  scene.world.kill_box = {Vec3(-0.2, -0.05, -0.1), Vec3(0.1, 0.3, 0.1)};
  return scene;
}

}  // namespace

ValidationCase torricelli_case() {
  return {"torricelli",
          "water 200 mm deep leaves a tank through a slot of 20 mm, 50 mm above its floor",
          "Torricelli's law; contraction of a plane jet from a thin wall, π/(π + 2) (Kirchhoff)",
          {0.005, 0.004, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Jet>(); }};
}

}  // namespace oilskin::demo
