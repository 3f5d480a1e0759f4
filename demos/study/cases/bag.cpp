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
constexpr double fall = 0.1;     // [s]; it is caught at 1 m/s

class Inside : public Probe {
 public:
  void after_step(const Moment& now) override {
    // Every tenth step: the count is slow, and what passes does not come back.
    const bool look = now.simulation.time().steps() % 10 == 0;
    const SurfaceMotion* bag = look ? now.simulation.cloth(0) : nullptr;
    if (bag == nullptr) return;
    const World& world = now.simulation.world();
    const ClosedSurface surface(*bag);
    std::uint64_t inside = 0;
    for (const Vec3& x : world.positions()) inside += surface.winding_number(x) == 1 ? 1 : 0;
    outside_ = std::max(outside_, world.particle_count() - inside);
    filled_ = std::max(filled_, world.particle_count());
    fewest_ = std::min(fewest_, inside);
    const double off = surface.volume() * water_density / world.fluid_mass() - 1;
    if (std::abs(off) > std::abs(worst_)) worst_ = off;
  }

  std::vector<Quantity> quantities(const Moment&) override {
    const double lost =
        static_cast<double>(std::max<std::uint64_t>(outside_, filled_ - std::min(fewest_, filled_)));
    return {{"particles that left the bag", lost, 0, 1, 0, 0},
            {"volume of the bag / of the water", 1 + worst_, 1, 0, 0, 0.05}};
  }

 private:
  std::uint64_t outside_ = 0, filled_ = 0, fewest_ = UINT64_MAX;
  double worst_ = 0;  // volume of the bag over that of the water, less 1
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.4);
  const Mesh ball = ball_mesh(Vec3::Zero(), radius, 8);
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
          {0.01, 0.005, 0.004},
          scene_at,
          [](const Scene&) { return std::make_unique<Inside>(); }};
}

}  // namespace oilskin::demo
