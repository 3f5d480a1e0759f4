#include "scene/unused_keys.h"

#include <algorithm>
#include <initializer_list>

#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

const Json* part_of(const Json* object, const char* key) {
  return object != nullptr && object->contains(key) ? &(*object)[key] : nullptr;
}

const Json* item_of(const Json* object, const char* list, std::size_t i) {
  const Json* all = part_of(object, list);
  return all != nullptr && i < all->size() ? &(*all)[i] : nullptr;
}

/// Looks at the keys of one object of the file.
class Finder {
 public:
  /// `object` is null where the file has none; `usual` has the defaults.
  Finder(const Json* object, const Json* usual, std::string path, std::vector<std::string>& found)
      : object_(object), usual_(usual), path_(std::move(path)), found_(found) {}

  Finder at(const char* key) const {
    return Finder(part_of(object_, key), part_of(usual_, key), path_ + key + ".", found_);
  }
  Finder at(const char* list, std::size_t i) const {
    return Finder(item_of(object_, list, i), item_of(usual_, list, 0),
                  path_ + list + "." + std::to_string(i) + ".", found_);
  }

  /// `keys` have no effect unless `used`. Reports name every key; so a default is not worth a word.
  void require(bool used, std::initializer_list<const char*> keys, const std::string& why) const {
    if (used) return;
    for (const char* key : keys) {
      const Json *given = part_of(object_, key), *usual = part_of(usual_, key);
      if (given != nullptr && (usual == nullptr || *given != *usual))
        found_.push_back(path_ + key + " has no effect: " + why);
    }
  }

 private:
  const Json *object_, *usual_;
  std::string path_;
  std::vector<std::string>& found_;
};

void find_in_fluid(const Finder& fluid, const FluidSettings& s) {
  fluid.require(s.solver == PressureSolver::mcg03, {"stiffness"}, "fluid.solver is not \"mcg03\"");
  fluid.require(s.solver == PressureSolver::dfsph, {"divergence_tolerance", "gradient_correction"},
                "fluid.solver is not \"dfsph\"");
  fluid.require(s.solver != PressureSolver::mcg03,
                {"tolerance", "min_iterations", "max_iterations", "contact_aware"},
                "fluid.solver is \"mcg03\"");
}

void find_in_water_mesh(const Finder& mesh, const WaterMeshSettings& s) {
  const bool wet = s.mode == ObstacleMode::wet, overlaps = s.mode == ObstacleMode::overlap;
  mesh.require(wet || overlaps || s.mode == ObstacleMode::touch, {"touch_range"},
               "surface.mode is not \"touch\", \"overlap\" or \"wet\"");
  mesh.require(overlaps, {"overlap_depth"}, "surface.mode is not \"overlap\"");
  mesh.require(wet, {"wet_saturation", "wet_blend"}, "surface.mode is not \"wet\"");
}

bool has_channel(const WaterMeshSettings& s, const std::string& name) {
  return std::find(s.channels.begin(), s.channels.end(), name) != s.channels.end();
}

Json defaults() {
  Scene scene;
  scene.cloth.resize(1);
  scene.water_mesh.emplace();
  return write_scene(scene);
}

}  // namespace

std::vector<std::string> unused_keys(const Json& json, const Scene& scene) {
  static const Json usual = defaults();
  std::vector<std::string> found;
  const Finder all(&json, &usual, "", found);
  const bool wets = scene.effects.wetting.has_value();
  all.require(scene.adaptive_dt, {"min_dt"}, "adaptive_dt is false");
  all.require(!scene.adaptive_dt || scene.min_dt <= scene.dt, {"min_dt"}, "it is longer than dt");
  find_in_fluid(all.at("fluid"), scene.fluid);
  all.at("contact").require(scene.contact.repulsion == Repulsion::bridson, {"stiffness"},
                            "contact.repulsion is not \"bridson\"");
  for (std::size_t i = 0; i < scene.cloth.size(); ++i)
    all.at("cloth", i).require(wets, {"fabric", "waterproof"}, "the scene has no effects.wetting");
  if (!scene.water_mesh) return found;
  find_in_water_mesh(all.at("surface"), *scene.water_mesh);
  if (has_channel(*scene.water_mesh, "wetness") && !wets)
    found.push_back("surface.channels: wetness is 0 everywhere, as the scene has no effects.wetting");
  return found;
}

}  // namespace oilskin::demo
