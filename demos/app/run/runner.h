/// Runs a scene from its file to its report.
#pragma once

#include "hosts/simulation.h"
#include "scene/options.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// The exit code. Throws SceneError for bad input, OutputError when the disk is full. `make_simulation` makes
/// the hosts that this program has.
int run_scene(const Scene& scene, const RunOptions& options, const MakeSimulation& make_simulation);

}  // namespace oilskin::demo
