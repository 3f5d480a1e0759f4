/// Cloth 0 sags below where it hangs without water.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

/// Index of the node in the middle of a cloth.
std::size_t centre_node(const ClothModel& model) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : model.rest) mean += x / static_cast<double>(model.rest.size());
  std::size_t best = 0;
  for (std::size_t i = 1; i < model.rest.size(); ++i)
    if ((model.rest[i] - mean).squaredNorm() < (model.rest[best] - mean).squaredNorm()) best = i;
  return best;
}

/// Where that node of cloth 0 is; `otherwise` where the cloth was left out.
Vec3 centre_of(const Simulation& simulation, const Vec3& otherwise) {
  const SurfaceMotion* motion = simulation.cloth(0);
  return motion != nullptr ? motion->x_t1[centre_node(simulation.models()[0])] : otherwise;
}

class SagBelowDry : public Check {
 public:
  void describe(Fields& f) override { f.number("sag_below_dry", at_least_, any_number()); }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, 0, "acceptance.sag_below_dry");
  }

  /// Runs the same cloth without water, with the same steps: how stiff it is depends on them.
  std::vector<CheckResult> results(const RunEnd& end) override {
    SimulationOptions options = end.options;
    options.emitters = false;
    const auto dry = end.make_simulation(end.scene, options);
    for (const SimulatedTime::Run& run : end.simulation.time().runs())
      for (std::uint64_t s = 0; s < run.count; ++s) dry->step(run.dt);
    const Vec3 wet_centre = centre_of(end.simulation, Vec3::Zero());
    const Vec3 dry_centre = centre_of(*dry, wet_centre);
    const Vec3 down = end.scene.world.gravity.normalized();
    return {at_least("sag_below_dry", (wet_centre - dry_centre).dot(down), at_least_)};
  }

 private:
  double at_least_ = 0;  // [m]
};

}  // namespace

std::unique_ptr<Check> make_sag_below_dry() {
  return std::make_unique<SagBelowDry>();
}

}  // namespace oilskin::demo
