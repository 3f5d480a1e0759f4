#include "hosts/scene_effects.h"

#include "hosts/simulation.h"

namespace oilskin::demo {

EffectList add_effects(const Scene&, World& world) {
  EffectList effects;
  for (const auto& effect : effects) require(world.add_effect(*effect), "effects." + effect->name());
  return effects;
}

}  // namespace oilskin::demo
