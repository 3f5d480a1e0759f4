/// At least so many particles left cloth 0 over its rim.
#include "checks/check.h"

#include <algorithm>
#include <unordered_set>

namespace oilskin::demo {
namespace {

constexpr double below_rim = 0.02;  // [m]

class MinOverRim : public Check {
 public:
  void describe(Fields& f) override { f.integer("min_over_rim", at_least_, between(0, 2e9)); }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, 0, "acceptance.min_over_rim");
  }

  void after_step(const Moment& now) override {
    if (!now.look) return;
    const std::vector<Vec3>& rest = now.simulation.models()[0].rest;
    const Vec3 n = up_of(now.scene);
    Box outline;
    double rim = never;
    for (const Vec3& x : rest) outline.add(x);
    for (const Vec3& x : rest) rim = std::min(rim, x.dot(n));
    const World& world = now.simulation.world();
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const Vec3& x = world.positions()[i];
      // Clamped to the outline in all but the vertical, a particle over the rim moves.
      const Vec3 off = x - x.cwiseMax(outline.min).cwiseMin(outline.max);
      if ((off - n * off.dot(n)).norm() > 0 && x.dot(n) < rim - below_rim) seen_.insert(world.ids()[i]);
    }
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    return {at_least("over_rim", static_cast<double>(seen_.size()), at_least_)};
  }

 private:
  int at_least_ = 0;
  std::unordered_set<std::uint64_t> seen_;  // ids, outside and below cloth 0
};

}  // namespace

std::unique_ptr<Check> make_min_over_rim() {
  return std::make_unique<MinOverRim>();
}

}  // namespace oilskin::demo
