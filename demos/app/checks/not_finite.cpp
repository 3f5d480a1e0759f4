/// Every number of particles and cloth is finite, and none had to be removed because it was not.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

std::uint64_t count_not_finite(Span<const Vec3> values) {
  std::uint64_t count = 0;
  for (const Vec3& v : values) count += v.allFinite() ? 0 : 1;
  return count;
}

class NotFinite : public Check {
 public:
  std::vector<CheckResult> results(const RunEnd& end) override {
    const World& world = end.simulation.world();
    std::uint64_t count = end.totals.removed_invalid;
    count += count_not_finite(world.positions()) + count_not_finite(world.velocities());
    for (std::size_t c = 0; c < end.scene.cloth.size(); ++c) {
      const SurfaceMotion* motion = end.simulation.cloth(c);
      if (motion == nullptr) continue;
      count += count_not_finite(motion->x_t1) + count_not_finite(motion->velocity);
    }
    return {at_most("not_finite", static_cast<double>(count), 0)};
  }
};

}  // namespace

std::unique_ptr<Check> make_not_finite() {
  return std::make_unique<NotFinite>();
}

}  // namespace oilskin::demo
