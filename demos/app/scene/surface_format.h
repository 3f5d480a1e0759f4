/// Keys that cloth, bodies and pins share.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

void describe(Fields& f, SurfaceSettings& s);
void describe(Fields& f, Motion& m);

}  // namespace oilskin::demo
