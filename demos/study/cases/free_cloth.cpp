/// A plug of water hits a free sheet.
#include <algorithm>
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/measures.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double breadth = 0.04, plug = 0.06, start = 0.08;  // of the tube and of the water [m]
constexpr double speed = 1;                                  // [m/s]
// The sheet is as wide as the tube, but for what closes it: a dry rim would swing forward past the water.
constexpr double beyond = 0.0005;  // [m]
constexpr double window = 0.05;    // common speed: mean over the end of the run [s]

/// Walls without friction give no momentum along the tube, x. The sheet's own sum of m v has the rounding of
/// its host, which takes velocities from positions: it is held against the number of steps.
class Impact : public Probe {
 public:
  void after_step(const Moment& now) override {
    const World& world = now.simulation.world();
    const SurfaceMotion& sheet = *now.simulation.cloth(0);
    const double water = fluid_momentum(world).x(), cloth = free_momentum(sheet).x();
    brought_ = world.fluid_mass() * speed;
    given_ += impulse_on(&sheet).x();
    exchange_ = std::max(exchange_, std::abs(water + given_ - brought_));
    drift_ = std::max(drift_, std::abs(water + cloth - brought_));
    made_ = std::max(made_, world.report().energy.made_fraction());
    if (!in_last(window, now)) return;
    water_.add(water / world.fluid_mass(), now.dt);
    sheet_.add(cloth / free_mass(sheet), now.dt);
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const double mass = end.simulation.world().fluid_mass(), sheet = free_mass(*end.simulation.cloth(0));
    const double common = brought_ / (mass + sheet);
    const auto steps = static_cast<double>(end.simulation.time().steps());
    return {{"momentum of water and impulses, change", exchange_ / brought_, 0, 1, 0, 1e-12},
            {"momentum of water and sheet, per step", drift_ / (brought_ * steps), 0, 1, 0, 1e-12},
            {"energy made / scale", made_, 0, 1, 0, 0.01},
            {"speed of the water [m/s]", water_.value(), common, 0, 0, 0.02},
            {"speed of the sheet [m/s]", sheet_.value(), common, 0, 0, 0.02}};
  }

 private:
  double brought_ = 0, given_ = 0, exchange_ = 0, drift_ = 0;  // [N s]
  double made_ = 0;                                            // of EnergyReport::scale
  TimeMean water_, sheet_;                                     // [m/s]
};

Body tube() {
  const double low = -0.2;
  const Vec3 along(1, 0, 0), up(0, breadth, 0), across(0, 0, breadth);
  Mesh mesh;
  for (const double side : {0.0, 1.0}) {
    append(mesh, sheet_mesh(Vec3(low, 0, 0) + side * up, along, across));
    append(mesh, sheet_mesh(Vec3(low, 0, 0) + side * across, along, up));
  }
  return mesh_body(std::move(mesh));
}

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.3);
  scene.world.gravity.setZero();
  FilledBox water = water_box(Vec3::Zero(), Vec3(plug, breadth, breadth));
  water.velocity = Vec3(speed, 0, 0);
  scene.emitters = {water};
  scene.bodies = {tube()};
  Cloth sheet;
  sheet.grid = {7, 7};
  sheet.size = {breadth + 2 * beyond, breadth + 2 * beyond};
  sheet.center = Vec3(start, 0.5 * breadth, 0.5 * breadth);
  sheet.normal = Vec3(1, 0, 0);
  sheet.u_axis = Vec3(0, 0, 1);
  sheet.areal_density = 10;
  sheet.bend_links = true;
  scene.cloth = {sheet};
  return scene;
}

}  // namespace

ValidationCase free_cloth_case() {
  return {"free_cloth",
          "plug of water in a tube hits a free sheet at 1 m/s, no gravity",
          "conservation of momentum; speed k m v/(M + k m) of a plastic impact",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Impact>(); }};
}

}  // namespace oilskin::demo
