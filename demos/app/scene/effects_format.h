/// The effects of a scene: scene key "effects".
#pragma once

#include "scene/fields.h"
#include "scene/scene.h"

namespace oilskin::demo {

void describe(Fields& f, SceneEffects& effects);
/// The keys of a fabric, among others of an object.
void describe(Fields& f, Fabric& fabric);

}  // namespace oilskin::demo
