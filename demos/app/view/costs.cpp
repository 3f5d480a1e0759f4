#include "view/costs.h"

#include <algorithm>

namespace oilskin::demo {

double sum_of(const std::vector<CostPart>& parts) {
  double sum = 0;
  for (const CostPart& part : parts) sum += part.seconds;
  return sum;
}

std::vector<CostPart> cost_parts(const StepCosts& costs) {
  const StageSeconds& s = costs.stages;
  std::vector<CostPart> parts = {{"host", costs.host, {141, 110, 99}},
                                 {"gather", s.gather, {188, 170, 164}},
                                 {"neighbours", s.neighbours, {144, 202, 249}},
                                 {"pressure", s.pressure, {30, 136, 229}},
                                 {"occlusion", s.occlusion, {128, 203, 196}},
                                 {"boundary", s.boundary, {0, 137, 123}},
                                 {"other fluid", s.other_fluid, {121, 134, 203}},
                                 {"effects", s.effects, {171, 71, 188}},
                                 {"proximity", s.proximity, {255, 213, 79}},
                                 {"impulses", s.impulses, {255, 167, 38}},
                                 {"continuous", s.ccd, {244, 81, 30}},
                                 {"zones", s.zones, {183, 28, 28}},
                                 {"verify", s.verify, {104, 159, 56}}};
  parts.push_back({"other", std::max(0.0, costs.total - sum_of(parts)), {189, 189, 189}});
  return parts;
}

std::vector<CostPart> cost_parts(const FrameCosts& costs) {
  return {{"steps", costs.steps, {30, 136, 229}},
          {"shapes", costs.shapes, {255, 167, 38}},
          {"water mesh", costs.water_mesh, {0, 137, 123}},
          {"drawing", costs.drawing, {171, 71, 188}}};
}

}  // namespace oilskin::demo
