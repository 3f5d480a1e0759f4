/// Layers of a cloth lie closer together than its thickness.
#include "checks/check.h"

#include <algorithm>

namespace oilskin::demo {
namespace {

constexpr double layer_distance = 10;  // nodes so many thicknesses apart at rest are not of one layer

/// Nodes that lie within the thickness of a node that is far from them in the cloth's rest shape.
std::uint64_t count_close_nodes(const SurfaceMotion& motion, const std::vector<Vec3>& rest) {
  const std::vector<Vec3>& x = motion.x_t1;
  const double h = motion.thickness;
  std::vector<std::size_t> order(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return x[i].x() < x[j].x(); });
  std::vector<std::uint8_t> close(x.size(), 0);
  for (std::size_t a = 0; a < order.size(); ++a) {
    for (std::size_t b = a + 1; b < order.size() && x[order[b]].x() - x[order[a]].x() < h; ++b) {
      const std::size_t i = order[a], j = order[b];
      if ((x[i] - x[j]).norm() < h && (rest[i] - rest[j]).norm() > layer_distance * h)
        close[i] = close[j] = 1;
    }
  }
  return static_cast<std::uint64_t>(std::count(close.begin(), close.end(), 1));
}

class CloseLayers : public Check {
 public:
  void describe(Fields& f) override {
    f.object("close_layers", [this](Fields& g) {
      g.integer("cloth", cloth_, between(0, 1e6));
      g.integer("at_least", at_least_, between(1, 1e9));
    });
  }
  void check_scene(const Scene& scene) const override {
    check_cloth_index(scene, cloth_, "acceptance.close_layers.cloth");
  }

  void after_step(const Moment& now) override {
    const SurfaceMotion* motion = now.look ? cloth_of(now, cloth_) : nullptr;
    if (motion == nullptr) return;
    const ClothModel& model = now.simulation.models()[static_cast<std::size_t>(cloth_)];
    nodes_ = std::max(nodes_, count_close_nodes(*motion, model.rest));
  }

  std::vector<CheckResult> results(const RunEnd&) override {
    return {at_least("close_layers", static_cast<double>(nodes_), at_least_)};
  }

 private:
  int cloth_ = 0;
  int at_least_ = 1;         // most nodes seen at a time so close to a node of another layer
  std::uint64_t nodes_ = 0;  // the most that were seen
};

}  // namespace

std::unique_ptr<Check> make_close_layers() {
  return std::make_unique<CloseLayers>();
}

}  // namespace oilskin::demo
