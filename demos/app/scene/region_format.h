/// Keys of sinks and force fields.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

/// Refuses a sink that is all of space.
void describe_sink(Fields& f, Region& r);
void describe(Fields& f, Force& force);

}  // namespace oilskin::demo
