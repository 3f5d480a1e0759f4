/// A vertical sheet between water of two depths.
#include "study/cases/case_table.h"
#include "study/cases/two_sides.h"

namespace oilskin::demo {
namespace {

class DifferenceOfHeads : public SheetForce {
 public:
  std::vector<Quantity> quantities(const Moment& end) override {
    const double exact = one_sided(end, -1) - one_sided(end, 1);
    return {{"force on the sheet [N]", force(), exact, 0, 0, 0.015, 1}};
  }
};

}  // namespace

ValidationCase sheet_levels_case() {
  return {"sheet_levels",
          "pinned vertical sheet between water of 60 mm and of 30 mm",
          "hydrostatics, F = ρ g b (h1² − h2²)/2; depths from the mass of the water",
          {0.01, 0.005, 0.0025},
          [](double spacing) {
            return two_sides_scene({0.06, 0.03, false}, spacing);
          },
          [](const Scene&) { return std::make_unique<DifferenceOfHeads>(); }};
}

}  // namespace oilskin::demo
