/// Every frame's mesh of the water is closed, and apart from cloth and bodies by the gap.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

class WaterMeshes : public Check {
 public:
  /// Modes that do not keep away from obstacles fail where they cut them.
  std::vector<CheckResult> results(const RunEnd& end) override {
    const MeshTotals& meshes = end.meshes;
    if (meshes.frames == 0) return {};
    const auto none = [](const char* name, std::uint64_t count) {
      return at_most(name, static_cast<double>(count), 0);
    };
    if (end.scene.water_mesh->mode == ObstacleMode::overlap) return {none("surface_flaws", meshes.flaws)};
    return {none("surface_flaws", meshes.flaws), none("surface_intersections", meshes.intersecting_pairs),
            none("surface_submerged", meshes.submerged), none("surface_below_gap", meshes.near_pairs)};
  }
};

}  // namespace

std::unique_ptr<Check> make_water_meshes() {
  return std::make_unique<WaterMeshes>();
}

}  // namespace oilskin::demo
