/// The water inside a closed cloth stays inside, and the rest outside.
#include "checks/check.h"

#include <unordered_map>

#include "geometry/closed_surface.h"

namespace oilskin::demo {
namespace {

class InsideConstant : public Check {
 public:
  void describe(Fields& f) override {
    f.object("inside_constant", [this](Fields& g) {
      g.integer("cloth", cloth_, between(0, 1e6));
      g.integer("every", every_, between(1, 1e9));
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, cloth_, "acceptance.inside_constant.cloth");
  }

  void after_step(const Moment& now) override {
    if ((now.simulation.time().steps() - 1) % std::uint64_t(every_) == 0) look(now.simulation);
  }

  /// A cloth without water inside, or one that was never looked at, keeps no promise.
  std::vector<CheckResult> results(const RunEnd& end) override {
    look(end.simulation);
    return {at_least("inside", static_cast<double>(inside_), 1),
            at_most("inside_changed", looks_ > 1 ? static_cast<double>(changed_) : never, 0)};
  }

 private:
  void look(Simulation& simulation) {
    const SurfaceMotion* motion = simulation.cloth(static_cast<std::size_t>(cloth_));
    if (motion == nullptr) return;
    const World& world = simulation.world();
    const ClosedSurface surface(*motion);
    if (looks_++ > 0) return compare(world, surface);
    if (!surface.closed()) changed_ = world.particle_count();  // it has no inside
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const int turns = surface.winding_number(world.positions()[i]);
      winding_[world.ids()[i]] = turns;
      inside_ += turns != 0 ? 1 : 0;
    }
  }

  void compare(const World& world, const ClosedSurface& surface) {
    std::uint64_t known = 0;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const auto before = winding_.find(world.ids()[i]);
      if (before == winding_.end() || before->second != surface.winding_number(world.positions()[i]))
        ++changed_;
      if (before != winding_.end()) ++known;
    }
    changed_ += winding_.size() - known;  // those that are gone
  }

  int cloth_ = 0;
  int every_ = 10;             // steps from look to look
  std::uint64_t inside_ = 0;   // particles inside the cloth at the first look
  std::uint64_t changed_ = 0;  // that came, went or changed sides since, summed over looks
  std::uint64_t looks_ = 0;
  std::unordered_map<std::uint64_t, int> winding_;  // by id, at the first look
};

}  // namespace

std::unique_ptr<Check> make_inside_constant() {
  return std::make_unique<InsideConstant>();
}

}  // namespace oilskin::demo
