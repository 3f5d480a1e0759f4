/// The water's surface is level: little of it is above the pool that it would be at rest.
#include "checks/check.h"

#include <algorithm>

#include "geometry/pool.h"

namespace oilskin::demo {
namespace {

class PoolLevel : public Check {
 public:
  void describe(Fields& f) override {
    f.object("pool_level", [this](Fields& g) {
      g.integer("cloth", cloth_, between(0, 1e6));
      g.number("middle", middle_, positive());
      g.number("above", above_, not_negative());
      g.number("fraction", fraction_, not_negative());
      g.number("window", window_, positive());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, cloth_, "acceptance.pool_level.cloth");
    check_has_weight(scene);
  }

  void after_step(const Moment& now) override {
    const SurfaceMotion* motion = in_last(window_, now) ? cloth_of(now, cloth_) : nullptr;
    if (motion == nullptr) return;
    const Vec3 up = up_of(now.scene);
    const PoolSurface pool = pool_surface(*motion, up, water_volume(now.scene, now.simulation));
    // The height of the top layer's particles, found in two ways; the lower counts. Water that is piled up in
    // the middle does not lift the pool that the volume gives, and water that hangs on the cloth is missed in
    // the middle.
    const double spacing = now.scene.fluid.spacing;
    const Span<const Vec3> positions = now.simulation.world().positions();
    const double level =
        std::min(pool.height - 0.5 * spacing, level_in_middle(*motion, positions, up, middle_));
    // A basin that cannot hold the water has no pool: all of it is in the wrong place.
    above_pool_.add(pool.in_rim ? fraction_above(positions, up, level + above_ * spacing) : 1, now.dt);
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    return {at_most("pool_level", above_pool_.empty() ? never : above_pool_.value(), fraction_)};
  }

 private:
  int cloth_ = 0;           // the basin
  double middle_ = 0.05;    // the level is looked at so far about the basin's deepest node [m]
  double above_ = 1;        // counts what is farther above the level [spacings]
  double fraction_ = 0.05;  // of the water, mean over the window, at most
  double window_ = 0.1;     // the last seconds of the run
  TimeMean above_pool_;     // fraction of the water
};

}  // namespace

std::unique_ptr<Check> make_pool_level() {
  return std::make_unique<PoolLevel>();
}

}  // namespace oilskin::demo
