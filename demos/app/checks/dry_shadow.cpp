/// No particle below a cloth, inside its outline shrunk by a margin.
#include "checks/check.h"

#include "geometry/shadow.h"

namespace oilskin::demo {
namespace {

class DryShadow : public Check {
 public:
  void describe(Fields& f) override {
    f.object("dry_shadow", [this](Fields& g) {
      g.integer("cloth", cloth_, between(0, 1e6));
      g.number("margin", margin_, not_negative());
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, cloth_, "acceptance.dry_shadow.cloth");
  }

  void after_step(const Moment& now) override {
    const SurfaceMotion* motion = now.look ? cloth_of(now, cloth_) : nullptr;
    if (motion == nullptr) return;
    const Shadow shadow(*motion, -up_of(now.scene));
    for (const Vec3& x : now.simulation.world().positions())
      if (shadow.covers(x, margin_)) ++seen_;
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    return {at_most("in_shadow", static_cast<double>(seen_), 0)};
  }

 private:
  int cloth_ = 0;
  double margin_ = 0.05;    // [m]
  std::uint64_t seen_ = 0;  // particles below the cloth, summed over looks
};

}  // namespace

std::unique_ptr<Check> make_dry_shadow() {
  return std::make_unique<DryShadow>();
}

}  // namespace oilskin::demo
