/// Emitters and placed meshes in scene files.
#pragma once

#include "scene/fields.h"
#include "scene/scene.h"

namespace oilskin::demo {

void describe(Fields& f, PlacedMesh& mesh);
void describe_emitter(Fields& f, Emitter& emitter);

}  // namespace oilskin::demo
