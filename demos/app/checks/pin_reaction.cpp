/// Mean vertical reaction of the pins against the weight of cloth and water.
#include "checks/check.h"

#include <cmath>

namespace oilskin::demo {
namespace {

/// The impulse of the pins is the change of momentum of the free nodes, less gravity and the water, plus what
/// the water gave to pinned nodes directly. Links are internal to the cloth. The fluid's momentum is not
/// used.
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
    velocity_before_.resize(now.scene.cloth.size());
    const Vec3 up = up_of(now.scene);
    double gained = 0, free_mass = 0;
    for (std::size_t c = 0; c < now.scene.cloth.size(); ++c) {
      const SurfaceMotion* motion = now.simulation.cloth(c);
      if (motion == nullptr) continue;
      const bool known = velocity_before_[c].size() == motion->velocity.size();
      for (std::size_t i = 0; i < motion->velocity.size() && known; ++i) {
        const double j = motion->impulse[i].dot(up);
        gained -= j;  // a pin takes the impulse on a pinned node; a free node's change below contains j
        if (motion->inverse_mass[i] == 0) continue;
        const double m = 1 / motion->inverse_mass[i];
        gained += m * (motion->velocity[i] - velocity_before_[c][i]).dot(up);
        free_mass += m;
      }
      velocity_before_[c] = motion->velocity;
    }
    if (in_last(window_, now)) book(now, gained, free_mass);
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    const double off = weight_impulse_ > 0 ? std::abs(reaction_impulse_ / weight_impulse_ - 1) : never;
    return {at_most("pin_reaction", off, tolerance_)};
  }

 private:
  void book(const Moment& now, double gained, double free_mass) {
    const World& world = now.simulation.world();
    const double g = now.scene.world.gravity.norm();
    const double water = world.fluid_mass();
    reaction_impulse_ += gained + free_mass * g * now.dt;
    weight_impulse_ += (free_mass + water) * g * now.dt;
  }

  double tolerance_ = 0.01;
  double window_ = 1;                               // the last seconds of the run
  double reaction_impulse_ = 0;                     // of the pins, upwards, in the window [N s]
  double weight_impulse_ = 0;                       // of free cloth and water over the window [N s]
  std::vector<std::vector<Vec3>> velocity_before_;  // per cloth, as the last step left them
};

}  // namespace

std::unique_ptr<Check> make_pin_reaction() {
  return std::make_unique<PinReaction>();
}

}  // namespace oilskin::demo
