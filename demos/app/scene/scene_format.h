/// The keys of a scene file, each named once for reading and writing.
#pragma once

#include "scene/fields.h"
#include "scene/scene.h"

namespace oilskin::demo {

void describe(Fields& f, Scene& scene);
void describe(Fields& f, WaterMeshSettings& surface);

}  // namespace oilskin::demo
