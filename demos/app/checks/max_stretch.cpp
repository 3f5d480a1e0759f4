/// No link of a cloth gets longer than so many times its rest length.
#include "checks/check.h"

#include <algorithm>

namespace oilskin::demo {
namespace {

class MaxStretch : public Check {
 public:
  void describe(Fields& f) override { f.number("max_stretch", at_most_, positive()); }

  void after_step(const Moment& now) override {
    if (!now.look) return;
    for (std::size_t c = 0; c < now.scene.cloth.size(); ++c) {
      const ClothModel& model = now.simulation.models()[c];
      const SurfaceMotion* motion = now.simulation.cloth(c);
      if (motion == nullptr) continue;
      for (const auto& [i, j] : model.links) {
        const double rest = (model.rest[i] - model.rest[j]).norm();
        stretch_ = std::max(stretch_, (motion->x_t1[i] - motion->x_t1[j]).norm() / rest);
      }
    }
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    return {at_most("stretch", stretch_, at_most_)};
  }

 private:
  double at_most_ = 0;  // length over rest length
  double stretch_ = 1;  // the largest seen
};

}  // namespace

std::unique_ptr<Check> make_max_stretch() {
  return std::make_unique<MaxStretch>();
}

}  // namespace oilskin::demo
