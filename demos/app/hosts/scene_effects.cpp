#include "hosts/scene_effects.h"

#include "hosts/simulation.h"

namespace oilskin::demo {

EffectList add_effects(const Scene& scene, World& world) {
  EffectList effects;
  if (scene.effects.viscosity)
    effects.push_back(std::make_unique<ImplicitViscosity>(*scene.effects.viscosity));
  for (const auto& effect : effects) require(world.add_effect(*effect), "effects." + effect->name());
  return effects;
}

}  // namespace oilskin::demo
