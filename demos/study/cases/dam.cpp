/// The dam break of Martin and Moyce, without a shift of time (checks/martin_moyce.h).
#include "checks/martin_moyce.h"

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double width = 0.05715, breadth = 0.045720;  // [m]; the breadth is 4/5 of the width

class Dam : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (!due_.reached(now)) return;
    DamPlace place;
    place.width = width;
    place.breadth = breadth;
    place.spacing = now.scene.fluid.spacing;
    run_.push_back(look_at_dam(now.simulation.world().positions(), place, now.t));
  }

  std::vector<Quantity> quantities(const Moment&) override {
    DamFit fit;
    fit.max_shift = 0;
    const DamComparison found = compare_with_martin_moyce(run_, width, earth, fit);
    // Two digitisations of the experiment agree within 2.5 %, and the gate opens in a finite time.
    return {{"front, mean difference", found.mean_front, 0, 1, 0.03, 0.08, 1},
            {"front, largest difference", found.front, 0, 1, 0.03},
            {"height at the wall, mean difference", found.mean_height, 0, 1, 0.03, 0.05, 1},
            {"height at the wall, largest difference", found.height, 0, 1, 0.03}};
  }

 private:
  Every due_{0.002};
  std::vector<DamMoment> run_;
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.2);
  const Vec3 along(0.4, 0, 0), up(0, 0.15, 0), across(0, 0, breadth), corner = Vec3::Zero();
  Mesh tank = sheet_mesh(corner, across, along, 5, 40);  // the floor, its front up
  append(tank, sheet_mesh(corner, up, across, 15, 5));
  append(tank, sheet_mesh(corner, along, up, 40, 15));
  append(tank, sheet_mesh(corner + across, up, along, 15, 40));
  scene.bodies = {mesh_body(tank)};
  scene.emitters = {water_box(corner, Vec3(width, 2 * width, breadth))};
  return scene;
}

}  // namespace

ValidationCase dam_case() {
  return {"dam",
          "a column of water collapses along a floor",
          "[Martin1952], n² = 2, a = 57.15 mm",
          {width / 5, width / 10, width / 20},
          scene_at,
          [](const Scene&) { return std::make_unique<Dam>(); }};
}

}  // namespace oilskin::demo
