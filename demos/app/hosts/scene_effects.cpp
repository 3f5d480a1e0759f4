#include "hosts/scene_effects.h"

#include <array>

#include "hosts/simulation.h"
#include "scene/effects_format.h"

namespace oilskin::demo {
namespace {

std::unique_ptr<Wetting> make_wetting(const Scene& scene, Span<const SurfaceId> cloth) {
  auto wetting = std::make_unique<Wetting>(*scene.effects.wetting);
  require(wetting->status(), "effects.wetting");
  for (std::size_t i = 0; i < cloth.size(); ++i) {
    if (scene.cloth[i].fabric)
      require(wetting->set_fabric(cloth[i], *scene.cloth[i].fabric),
              "cloth." + std::to_string(i) + ".fabric");
    if (scene.cloth[i].waterproof) wetting->set_waterproof(cloth[i]);
  }
  return wetting;
}

/// In the order in which they act.
constexpr std::array<const char*, 4> effect_keys = {"wetting", "surface_tension", "forces", "viscosity"};

std::unique_ptr<ForceFields> make_forces(const std::vector<Force>& forces) {
  auto fields = std::make_unique<ForceFields>();
  for (std::size_t i = 0; i < forces.size(); ++i)
    require(fields->add(forces[i]), "effects.forces." + std::to_string(i));
  return fields;
}

EffectList make_effects(const Scene& scene, Span<const SurfaceId> cloth) {
  EffectList effects;
  if (scene.effects.wetting) effects.push_back(make_wetting(scene, cloth));
  if (scene.effects.surface_tension)
    effects.push_back(std::make_unique<SurfaceTension>(*scene.effects.surface_tension));
  if (!scene.effects.forces.empty()) effects.push_back(make_forces(scene.effects.forces));
  // Sees the forces of those before it.
  if (scene.effects.viscosity)
    effects.push_back(std::make_unique<ImplicitViscosity>(*scene.effects.viscosity));
  return effects;
}

Json written(SceneEffects effects) {
  Json json;
  Fields fields = Fields::writer(json);
  describe(fields, effects);
  return json;
}

/// How many effects `before` and `after` begin with in common.
std::size_t common_effects(const Json& before, const Json& after) {
  std::size_t count = 0;
  for (const char* key : effect_keys) {
    const Json was = before.value(key, Json()), will_be = after.value(key, Json());
    if (was != will_be) break;
    if (!was.is_null()) ++count;
  }
  return count;
}

}  // namespace

EffectList add_effects(const Scene& scene, Span<const SurfaceId> cloth, World& world) {
  EffectList effects = make_effects(scene, cloth);
  for (const auto& effect : effects) require(world.add_effect(*effect), "effects." + effect->name());
  return effects;
}

SceneEffects change_effects(const Scene& scene, const SceneEffects& wanted, Span<const SurfaceId> cloth,
                            World& world, EffectList& effects) {
  const std::size_t kept = common_effects(written(scene.effects), written(wanted));
  Scene changed = scene;
  changed.effects = wanted;
  EffectList made = make_effects(changed, cloth);
  while (effects.size() > kept) {
    world.remove_effect(*effects.back());
    effects.pop_back();
  }
  for (std::size_t i = kept; i < made.size(); ++i) {
    require(world.add_effect(*made[i]), "effects." + made[i]->name());
    effects.push_back(std::move(made[i]));
  }
  return wanted;
}

std::vector<float> saturation(const Scene& scene, std::size_t cloth, const ClothModel& model,
                              const SurfaceMotion& motion) {
  const std::size_t n = model.mass.size();
  if (!scene.effects.wetting || motion.x_t1.size() != n) return {};
  std::vector<float> s(n, 0);
  if (motion.absorbed_mass.size() != n) return s;
  const Cloth& settings = scene.cloth[cloth];
  const Fabric& fabric = settings.fabric ? *settings.fabric : scene.effects.wetting->fabric;
  for (std::size_t i = 0; i < n; ++i) {
    const double area = model.mass[i] / settings.areal_density;
    s[i] = static_cast<float>(motion.absorbed_mass[i] / (fabric.capacity * area));
  }
  return s;
}

}  // namespace oilskin::demo
