/// The command line of `oilskin view`.
#pragma once

#include <optional>

#include "hosts/simulation.h"
#include "scene/options.h"

namespace oilskin::demo {

struct ViewOptions {
  RunOptions run;                       ///< scene, set, dt, seed, threads
  std::optional<std::uint64_t> frames;  ///< ends after so many frames, which are 1/30 s of time apart
  std::string screenshot;               ///< PNG of the last frame; empty = none
  std::string script, log;              ///< files; empty = none
  int width = 1280, height = 800;       ///< [pixels]
};

/// Shows a scene in a window until it is closed. Throws SceneError where there is no display or no window in
/// this program.
int view_scene(const Scene& scene, const ViewOptions& options, const MakeSimulation& make_simulation);

}  // namespace oilskin::demo
