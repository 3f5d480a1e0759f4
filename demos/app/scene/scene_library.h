/// The scene files that come with the program, and what the command line changes in a scene.
#pragma once

#include <string>
#include <vector>

#include "scene/options.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// The scene file that a name or a path means, with the command line's changes. Throws SceneError.
Scene load_scene(const RunOptions& options);

/// The folder of the scenes that come with the program.
std::string scenes_directory();
/// Their names, in order.
std::vector<std::string> shipped_scenes();

}  // namespace oilskin::demo
