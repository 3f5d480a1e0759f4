/// No surface was left out: one that was stops nothing any more.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class SurfacesLeftOut : public Check {
 public:
  std::vector<CheckResult> results(const RunEnd& end) override {
    return {at_most("surfaces_left_out", (end.totals.flags & flag_surface_refused) != 0 ? 1 : 0, 0)};
  }
};

}  // namespace

std::unique_ptr<Check> make_surfaces_left_out() {
  return std::make_unique<SurfacesLeftOut>();
}

}  // namespace oilskin::demo
