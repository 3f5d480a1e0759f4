/// effects.csv, effects.md and effects.svg (docs/manual/commands_and_formats.md).
#pragma once

#include <string>
#include <vector>

#include "output/effect_costs.h"

namespace oilskin::demo {

/// What the tables say of all runs.
struct EffectsTitle {
  std::string scene;
  std::string command;             ///< that repeats the measurement
  std::vector<std::string> notes;  ///< a sentence each
};

/// The first cost is that of no effects; all have as many runs.
std::string effects_csv(const std::vector<EffectCost>& costs);
std::string effects_markdown(const EffectsTitle& title, const std::vector<EffectCost>& costs);
std::string effects_svg(const EffectsTitle& title, const std::vector<EffectCost>& costs);

}  // namespace oilskin::demo
