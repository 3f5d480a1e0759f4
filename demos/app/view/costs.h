/// What a step and a frame cost, as the parts of a bar.
#pragma once

#include <string>
#include <vector>

#include "view/live_scene.h"

namespace oilskin::demo {

struct CostPart {
  const char* name;
  double seconds = 0;
  std::array<unsigned char, 3> colour{};
};

/// The stages of a step (StageSeconds), the host, and what is left of the whole. Their sum is
/// StepCosts::total, or more where stages overlap.
std::vector<CostPart> cost_parts(const StepCosts& costs);

/// What a frame of the window took [s].
struct FrameCosts {
  double steps = 0, shapes = 0, water_mesh = 0, drawing = 0;
};
std::vector<CostPart> cost_parts(const FrameCosts& costs);

double sum_of(const std::vector<CostPart>& parts);

}  // namespace oilskin::demo
