/// A vertical sheet with equal water on both sides.
#include <algorithm>
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/two_sides.h"

namespace oilskin::demo {
namespace {

class NoForce : public SheetForce {
 public:
  void after_step(const Moment& now) override {
    SheetForce::after_step(now);
    const SurfaceMotion* sheet = now.simulation.cloth(0);
    if (sheet == nullptr) return;
    for (const Vec3& x : sheet->x_t1) bulge_ = std::max(bulge_, std::abs(x.x()));
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const double spacing = end.scene.fluid.spacing;
    return {{"net force / force of one side", force() / one_sided(end, -1), 0, 1, 0, 0.01},
            {"largest bulge / spacing", bulge_ / spacing, 0, 1, 0, 1}};
  }

 private:
  double bulge_ = 0;  // [m]
};

}  // namespace

ValidationCase equal_heads_case() {
  return {"equal_heads",
          "sheet pinned at its border between water of 60 mm on both sides",
          "hydrostatics: the forces of both sides cancel",
          {0.01, 0.005, 0.0025},
          [](double spacing) {
            return two_sides_scene({0.06, 0.06, true}, spacing);
          },
          [](const Scene&) { return std::make_unique<NoForce>(); }};
}

}  // namespace oilskin::demo
