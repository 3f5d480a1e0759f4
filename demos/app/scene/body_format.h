/// Keys of a body.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

void describe(Fields& f, Body& b);

}  // namespace oilskin::demo
