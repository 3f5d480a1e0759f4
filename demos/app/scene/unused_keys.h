/// Keys of a scene file that change nothing because of what other keys say.
#pragma once

#include <string>
#include <vector>

#include "scene/fields.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// A sentence for each such key: its path, and why it has no effect. `json` is what `scene` was read from.
std::vector<std::string> unused_keys(const Json& json, const Scene& scene);

}  // namespace oilskin::demo
