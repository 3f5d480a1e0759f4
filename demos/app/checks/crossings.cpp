/// No particle crosses a surface, as the independent check finds.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class Crossings : public Check {
 public:
  std::vector<CheckResult> results(const RunEnd& end) override {
    if (!end.scene.contact.verify) return {};
    return {at_most("crossings", static_cast<double>(end.totals.contact.crossings_found_by_verify), 0)};
  }
};

}  // namespace

std::unique_ptr<Check> make_crossings() {
  return std::make_unique<Crossings>();
}

}  // namespace oilskin::demo
