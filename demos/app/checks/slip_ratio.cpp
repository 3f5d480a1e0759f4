/// Mean tangential speed of the particles next to two sheets, compared.
#include "checks/check.h"

#include "geometry/nearest_surface.h"

namespace oilskin::demo {
namespace {

class SlipRatio : public Check {
 public:
  void describe(Fields& f) override {
    f.object("slip_ratio", [this](Fields& g) {
      g.integer("free", free_cloth_, between(0, 1e6));
      g.integer("no_slip", no_slip_cloth_, between(0, 1e6));
      g.number("at_least", at_least_, positive());
      g.number("window", window_, positive());
      g.number("within", within_, positive());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, free_cloth_, "acceptance.slip_ratio.free");
    check_cloth_index(scene, no_slip_cloth_, "acceptance.slip_ratio.no_slip");
  }

  void after_step(const Moment& now) override {
    if (!now.look || !in_last(window_, now)) return;
    look_at(now, free_cloth_, beside_free_);
    look_at(now, no_slip_cloth_, beside_no_slip_);
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    const bool seen = !beside_free_.empty() && !beside_no_slip_.empty();
    return {
        at_least("slip_ratio", seen ? ratio(beside_free_.value(), beside_no_slip_.value()) : 0, at_least_)};
  }

 private:
  void look_at(const Moment& now, int cloth, TimeMean& speed) const {
    const SurfaceMotion* motion = cloth_of(now, cloth);
    if (motion == nullptr) return;
    NearestSurface nearest(within_ * now.scene.fluid.spacing);
    nearest.add(*motion, cloth);
    const World& world = now.simulation.world();
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      NearestSurface::Hit hit;
      if (!nearest.find(world.positions()[i], &hit) || hit.point.distance == 0) continue;
      Vec3 u = world.motions()[i];
      for (int k = 0; k < 3; ++k) u -= hit.point.weights[k] * motion->velocity[hit.nodes[k]];
      const Vec3 n = hit.point.offset / hit.point.distance;
      speed.add((u - n * n.dot(u)).norm(), now.since_look);
    }
  }

  int free_cloth_ = 0, no_slip_cloth_ = 1;  // indices of cloths
  double at_least_ = 5;                     // speed beside the one over speed beside the other
  double window_ = 0.1;                     // the last seconds of the run
  double within_ = 0.75;                    // of the sheet [spacings]
  TimeMean beside_free_, beside_no_slip_;   // [m/s]
};

}  // namespace

std::unique_ptr<Check> make_slip_ratio() {
  return std::make_unique<SlipRatio>();
}

}  // namespace oilskin::demo
