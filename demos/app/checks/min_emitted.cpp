/// At least so many particles were emitted.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class MinEmitted : public Check {
 public:
  void describe(Fields& f) override { f.integer("min_emitted", at_least_, between(0, 2e9)); }
  std::vector<CheckResult> results(const RunEnd& end) override {
    return {at_least("emitted", static_cast<double>(end.totals.emitted), at_least_)};
  }

 private:
  int at_least_ = 0;
};

}  // namespace

std::unique_ptr<Check> make_min_emitted() {
  return std::make_unique<MinEmitted>();
}

}  // namespace oilskin::demo
