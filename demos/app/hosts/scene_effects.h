/// The effects of a scene, as objects that a world uses.
#pragma once

#include <memory>
#include <vector>

#include "oilskin/world.h"
#include "scene/cloth_model.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Must outlive their stay in a world.
using EffectList = std::vector<std::unique_ptr<Effect>>;

/// Makes the effects of a scene and gives them to the world. `cloth`: the handles of the scene's cloth.
/// Throws SceneError for what is refused.
EffectList add_effects(const Scene& scene, Span<const SurfaceId> cloth, World& world);

/// Replaces the effects of a world by those of `wanted`, and returns `wanted`. Those before the first that
/// differs stay with their numbers; the others are made anew. Liquid in cloth stays there. Throws SceneError
/// for what is refused.
SceneEffects change_effects(const Scene& scene, const SceneEffects& wanted, Span<const SurfaceId> cloth,
                            World& world, EffectList& effects);

/// The saturation of each node of a cloth; empty where the scene has no wetting, or the surface has other
/// nodes than the model (welded ones).
std::vector<float> saturation(const Scene& scene, std::size_t cloth, const ClothModel& model,
                              const SurfaceMotion& motion);

}  // namespace oilskin::demo
