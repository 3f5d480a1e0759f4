/// Mean vertical reaction of the pins against the weight of cloth and water.
#include "checks/pin_impulse.h"

#include <cmath>

namespace oilskin::demo {
namespace {

class PinReaction : public Check {
 public:
  void describe(Fields& f) override {
    f.object("pin_reaction", [this](Fields& g) {
      g.number("tolerance", tolerance_, positive());
      g.number("window", window_, positive());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, 0, "acceptance.pin_reaction");
  }

  void after_step(const Moment& now) override {
    pins_.after_step(now);
    if (in_last(window_, now)) book(now);
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    const double off = weight_impulse_ > 0 ? std::abs(reaction_impulse_ / weight_impulse_ - 1) : never;
    return {at_most("pin_reaction", off, tolerance_)};
  }

 private:
  void book(const Moment& now) {
    const double g = now.scene.world.gravity.norm();
    reaction_impulse_ += pins_.last().dot(up_of(now.scene));
    weight_impulse_ += (pins_.free_mass() + now.simulation.world().fluid_mass()) * g * now.dt;
  }

  double tolerance_ = 0.01;
  double window_ = 1;            // the last seconds of the run
  double reaction_impulse_ = 0;  // of the pins, upwards, in the window [N s]
  double weight_impulse_ = 0;    // of free cloth and water over the window [N s]
  PinImpulse pins_;
};

}  // namespace

std::unique_ptr<Check> make_pin_reaction() {
  return std::make_unique<PinReaction>();
}

}  // namespace oilskin::demo
