/// A column that collapses along a floor, against Martin and Moyce's experiment (martin_moyce.h).
#include "checks/check.h"

#include <cmath>
#include <optional>

#include "checks/martin_moyce.h"

namespace oilskin::demo {
namespace {

class DamBreak : public Check {
 public:
  void describe(Fields& f) override {
    f.object("dam_break", [this](Fields& g) {
      g.vec3("foot", place_.foot);
      g.direction("along", place_.along);
      g.number("width", place_.width, positive());
      g.number("breadth", place_.breadth, positive());
      g.number("front", front_, positive());
      g.number("shift", shift_, between(0, 1));
      g.optional_number("height", height_, positive());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_has_weight(scene);
    if (std::abs(place_.along.normalized().dot(scene.world.gravity.normalized())) > 1e-6)
      throw SceneError("acceptance.dam_break.along: must be square to gravity");
  }

  void after_step(const Moment& now) override {
    if (!now.look) return;
    DamPlace place = place_;
    place.along = place_.along.normalized();
    place.up = up_of(now.scene);
    place.spacing = now.scene.fluid.spacing;
    run_.push_back(look_at_dam(now.simulation.world().positions(), place, now.t));
  }

  std::vector<CheckResult> results(const RunEnd& end) override {
    const DamFit fit{shift_, front_, height_.value_or(never)};
    const DamComparison found =
        compare_with_martin_moyce(run_, place_.width, end.scene.world.gravity.norm(), fit);
    // The shift is for the reader: how late the front is where it fits best. The search went no farther than
    // the limit.
    std::vector<CheckResult> all = {at_most("dam_front", found.front, front_),
                                    {"dam_time_shift", found.shift, shift_, std::abs(found.shift) <= shift_},
                                    {"dam_front_speed", found.speed, 1, found.speed > 0 && found.speed <= 1}};
    if (height_) all.push_back(at_most("dam_height", found.height, *height_));
    return all;
  }

 private:
  DamPlace place_;
  double front_ = 0.1;            // largest relative difference of the front
  double shift_ = 0.15;           // time by which it may be early or late [sqrt(a/2g)]
  std::optional<double> height_;  // largest relative difference of the column's height at the wall
  std::vector<DamMoment> run_;
};

}  // namespace

std::unique_ptr<Check> make_dam_break() {
  return std::make_unique<DamBreak>();
}

}  // namespace oilskin::demo
