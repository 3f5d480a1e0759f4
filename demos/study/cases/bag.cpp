/// A closed bag of cloth with water falls and is caught at its top.
#include <algorithm>
#include <cmath>

#include "geometry/closed_surface.h"
#include "study/cases/case_table.h"
#include "study/cases/parts.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double radius = 0.05;  // [m]
constexpr double window = 0.1;   // mean over the end of the run [s]
constexpr double fall = 0.1;     // [s]; it is caught at 1 m/s

class Inside : public Probe {
 public:
  void after_step(const Moment& now) override {
    if (!look_.reached(now)) return;
    const SurfaceMotion& bag = *now.simulation.cloth(0);
    const World& world = now.simulation.world();
    const ClosedSurface surface(bag);
    std::size_t inside = 0;
    for (const Vec3& x : world.positions()) inside += surface.winding_number(x) == 1 ? 1 : 0;
    if (filled_ == 0) filled_ = world.particle_count();
    fewest_ = std::min(fewest_, inside);
    const double volume = surface.volume() * water_density / world.fluid_mass();
    if (std::abs(volume - 1) > std::abs(farthest_ - 1)) farthest_ = volume;
    if (in_last(window, now)) last_.add(volume, 1);
  }

  std::vector<Quantity> quantities(const Moment&) override {
    return {{"particles inside / at the start", double(fewest_) / double(filled_), 1, 0, 0, 0},
            {"volume of the bag / of the water, farthest", farthest_, 1, 0, 0, 0.05, 1},
            {"volume of the bag / of the water, at the end", last_.value(), 1, 0, 0, 0.05, 1}};
  }

 private:
  Every look_{0.01};
  std::size_t filled_ = 0, fewest_ = SIZE_MAX;
  double farthest_ = 1;  // volume of the bag over that of the water
  TimeMean last_;
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.4);
  const Mesh ball = ball_mesh(Vec3::Zero(), radius, 5);
  Cloth bag = mesh_cloth(ball, 0.5);
  pin(bag, {Vec3(-1, 0.9 * radius, -1), Vec3::Constant(1)});
  bag.pins.boxes.front().hold = fall;
  scene.cloth = {bag};
  scene.emitters = {water_in(ball)};
  return scene;
}

}  // namespace

ValidationCase bag_case() {
  return {"bag",
          "closed bag of 50 mm radius, full of water, falls for 0.1 s and is caught at its top",
          "no particle passes; the volume of the water",
          {0.008, 0.005, 0.004},
          scene_at,
          [](const Scene&) { return std::make_unique<Inside>(); }};
}

}  // namespace oilskin::demo
