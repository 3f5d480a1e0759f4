/// Cloth absorbs, and releases drops.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class WettingCheck : public Check {
 public:
  void describe(Fields& f) override {
    f.object("wetting", [this](Fields& g) {
      g.number("min_absorbed", min_absorbed_, not_negative());
      g.integer("min_released", min_released_, between(0, 2e9));
    });
  }
  void check_scene(const Scene& scene) const override {
    if (!scene.effects.wetting) throw SceneError("acceptance.wetting: the scene has no effects.wetting");
  }
  std::vector<CheckResult> results(const RunEnd& end) override {
    const Totals& t = end.totals;
    return {at_least("absorbed", t.mass_absorbed, min_absorbed_),
            at_least("released", static_cast<double>(t.released), min_released_)};
  }

 private:
  double min_absorbed_ = 0;  // [kg]
  int min_released_ = 0;     // particles
};

}  // namespace

std::unique_ptr<Check> make_wetting() {
  return std::make_unique<WettingCheck>();
}

}  // namespace oilskin::demo
