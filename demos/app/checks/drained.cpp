/// The water ends in sinks, and nowhere else.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class Drained : public Check {
 public:
  void describe(Fields& f) override {
    f.object("drained", [this](Fields& g) {
      g.number("left", left_, between(0, 1));
      g.number("lost", lost_, between(0, 1));
    });
  }
  void check_scene(const Scene& scene) const override {
    if (scene.sinks.empty()) throw SceneError("acceptance.drained: the scene has no sinks");
  }

  std::vector<CheckResult> results(const RunEnd& end) override {
    const Totals& totals = end.totals;
    const auto emitted = static_cast<double>(totals.emitted);
    const auto alive = static_cast<double>(end.simulation.world().particle_count());
    const auto taken = static_cast<double>(totals.removed_by_sinks);
    const auto elsewhere = static_cast<double>(totals.removed) - taken;
    return {at_most("left", ratio(alive, emitted), left_), at_most("lost", ratio(elsewhere, emitted), lost_),
            at_most("ledger", std::abs(emitted - alive - taken - elsewhere), 0)};
  }

 private:
  double left_ = 0.05;  // of the water that was emitted, at most
  double lost_ = 0;     // of it, what ended elsewhere, at most
};

}  // namespace

std::unique_ptr<Check> make_drained() {
  return std::make_unique<Drained>();
}

}  // namespace oilskin::demo
