/// The keys of a scene file, each named once for reading and writing.
#pragma once

#include "fields.h"
#include "scene.h"

namespace oilskin::demo {

void describe(Fields& f, Scene& scene);
void describe(Fields& f, WaterSurface& surface);

}  // namespace oilskin::demo
