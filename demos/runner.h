/// Runs a scene from its file to its report.
#pragma once

#include <string>

#include "options.h"
#include "scene.h"

namespace oilskin::demo {

/// The scene file that a name or a path means, with the command line's changes. Throws SceneError.
Scene load_scene(const RunOptions& options);

/// The folder of the scenes that come with the program.
std::string scenes_directory();
/// Their names, in order.
std::vector<std::string> shipped_scenes();

/// The exit code. Throws SceneError for bad input, OutputError when the disk is full.
int run_scene(const Scene& scene, const RunOptions& options);

}  // namespace oilskin::demo
