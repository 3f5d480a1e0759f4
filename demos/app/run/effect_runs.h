/// The runs by which `oilskin effects` measures what effects cost.
#pragma once

#include <optional>

#include "output/effect_costs.h"
#include "scene/options.h"

namespace oilskin::demo {

/// No effects, each effect alone, all of them; without runs. An effect that the scene names has the scene's
/// settings, the others have those of water, cotton and syrup. The keys that the scene names are `named`.
std::vector<EffectCost> effect_configurations(const RunOptions& options, std::vector<std::string>& named);

/// The options of a run with `effects` into the folder `out`: without pictures, acceptance checks of the
/// scene and contact.verify, unless options.set gives them.
RunOptions options_with(const RunOptions& options, const Json& effects, const std::string& out);

/// Reads the scene of a run as the run will. Throws SceneError.
void check_scene_of(const RunOptions& options);

/// What an earlier run into the folder cost, if it had the same settings and threads, ran to its end, and
/// this program is not newer than its report.
std::optional<RunCost> cost_of_earlier_run(const RunOptions& options);

}  // namespace oilskin::demo
