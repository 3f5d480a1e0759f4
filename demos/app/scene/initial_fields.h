/// The initial state of a volume as a scene file describes it.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

/// Each list of fields is their sum.
InitialState initial_state(const InitialFields& fields, std::uint64_t seed);

}  // namespace oilskin::demo
