/// Vertical momentum that the fluid lost, from its particles, against what the nodes got, as the
/// hosts have it.
#include "checks/check.h"

#include <cmath>

namespace oilskin::demo {
namespace {

class VerticalMomentum : public Check {
 public:
  void describe(Fields& f) override { f.number("vertical_momentum", at_most_, positive()); }

  void after_step(const Moment& now) override {
    for (std::size_t i = 0; i < now.scene.cloth.size(); ++i) add(now.simulation.cloth(i));
    for (std::size_t i = 0; i < now.scene.bodies.size(); ++i) add(now.simulation.body(i));
  }

  std::vector<CheckResult> results(const RunEnd& end) override {
    const Totals& totals = end.totals;
    const Vec3 up = -end.scene.world.gravity.normalized();
    const Vec3 lost = totals.momentum_emitted + totals.momentum_gravity - totals.momentum_removed -
                      fluid_momentum(end.simulation.world());
    const double got = impulse_.dot(up);
    return {
        at_most("vertical_momentum", ratio(std::abs(lost.dot(up) - got), std::abs(lost.dot(up))), at_most_)};
  }

 private:
  void add(const SurfaceMotion* motion) {
    if (motion != nullptr)
      for (const Vec3& j : motion->impulse) impulse_ += j;
  }

  double at_most_ = 0;           // relative difference
  Vec3 impulse_ = Vec3::Zero();  // on the nodes of every surface [N s]
};

}  // namespace

std::unique_ptr<Check> make_vertical_momentum() {
  return std::make_unique<VerticalMomentum>();
}

}  // namespace oilskin::demo
