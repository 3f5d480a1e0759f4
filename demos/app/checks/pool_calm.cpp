/// The water's kinetic energy against the energy that lifts the pool's top layer by its own thickness.
#include "checks/check.h"

#include "geometry/pool.h"

namespace oilskin::demo {
namespace {

class PoolCalm : public Check {
 public:
  void describe(Fields& f) override {
    f.object("pool_calm", [this](Fields& g) {
      g.integer("cloth", cloth_, between(0, 1e6));
      g.number("fraction", fraction_, not_negative());
      g.number("window", window_, positive());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, cloth_, "acceptance.pool_calm.cloth");
    check_has_weight(scene);
  }

  void after_step(const Moment& now) override {
    const SurfaceMotion* motion = in_last(window_, now) ? cloth_of(now, cloth_) : nullptr;
    if (motion == nullptr) return;
    const PoolSurface pool = pool_surface(*motion, up_of(now.scene), water_volume(now.scene, now.simulation));
    const double spacing = now.scene.fluid.spacing;
    const double layer = now.scene.fluid.rest_density * pool.area * spacing;  // [kg]
    const double energy = layer * now.scene.world.gravity.norm() * spacing;
    const bool can_rest = pool.in_rim && energy > 0;
    energy_.add(can_rest ? kinetic_energy(now.simulation.world()) / energy : never, now.dt);
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    return {at_most("pool_calm", energy_.empty() ? never : energy_.value(), fraction_)};
  }

 private:
  int cloth_ = 0;           // the basin
  double fraction_ = 0.01;  // of one layer's energy, mean over the window, at most
  double window_ = 0.1;     // the last seconds of the run
  TimeMean energy_;         // over one layer's energy
};

}  // namespace

std::unique_ptr<Check> make_pool_calm() {
  return std::make_unique<PoolCalm>();
}

}  // namespace oilskin::demo
