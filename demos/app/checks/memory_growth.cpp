/// The memory that the program holds at the end against that after a fifth of the run.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class MemoryGrowth : public Check {
 public:
  void describe(Fields& f) override { f.number("memory_growth", at_most_, not_negative()); }
  std::vector<CheckResult> results(const RunEnd& end) override {
    const double before = static_cast<double>(end.memory.after_a_fifth());
    const double after = static_cast<double>(end.memory.at_end());
    return {at_most("memory_growth", before > 0 ? after / before - 1 : never, at_most_)};
  }

 private:
  double at_most_ = 0;  // relative
};

}  // namespace

std::unique_ptr<Check> make_memory_growth() {
  return std::make_unique<MemoryGrowth>();
}

}  // namespace oilskin::demo
