/// The volume that a closed cloth encloses over the volume of the water.
#include "checks/check.h"

#include <algorithm>
#include <sstream>

#include "geometry/closed_surface.h"

namespace oilskin::demo {
namespace {

class EnclosedVolume : public Check {
 public:
  void describe(Fields& f) override {
    f.object("enclosed_volume", [this](Fields& g) {
      g.integer("cloth", cloth_, between(0, 1e6));
      g.number("at_least", at_least_, not_negative());
      g.number("at_most", at_most_, positive());
      g.number("from", from_, not_negative());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, cloth_, "acceptance.enclosed_volume.cloth");
    if (at_least_ <= at_most_) return;
    std::ostringstream text;
    text << "acceptance.enclosed_volume.at_least: is " << at_least_ << ", must be at most at_most, which is "
         << at_most_;
    throw SceneError(text.str());
  }

  void after_step(const Moment& now) override {
    const SurfaceMotion* motion = now.look && now.t > from_ ? cloth_of(now, cloth_) : nullptr;
    const double water = water_volume(now.scene, now.simulation);
    if (motion == nullptr || !(water > 0)) return;
    const double volume = ClosedSurface(*motion).volume() / water;
    smallest_ = std::min(smallest_, volume);
    largest_ = std::max(largest_, volume);
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    const bool seen = largest_ > 0;
    return {at_least("least_volume", seen ? smallest_ : 0, at_least_),
            at_most("largest_volume", seen ? largest_ : never, at_most_)};
  }

 private:
  int cloth_ = 0;
  double at_least_ = 0.95, at_most_ = never;  // at every look
  double from_ = 0;                           // [s]
  double smallest_ = never, largest_ = 0;     // that were seen
};

}  // namespace

std::unique_ptr<Check> make_enclosed_volume() {
  return std::make_unique<EnclosedVolume>();
}

}  // namespace oilskin::demo
