/// The effects of a scene, as objects that a world uses.
#pragma once

#include <memory>
#include <vector>

#include "oilskin/world.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Must outlive their stay in a world.
using EffectList = std::vector<std::unique_ptr<Effect>>;

/// Makes the effects of a scene and gives them to the world. Throws SceneError for what is refused.
EffectList add_effects(const Scene& scene, World& world);

}  // namespace oilskin::demo
