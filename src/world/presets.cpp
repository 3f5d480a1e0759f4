#include "oilskin/presets.h"

#include <algorithm>
#include <cmath>

#include "fluid/stability.h"

namespace oilskin {

namespace {

double time_scale(double spacing) {
  return std::sqrt(spacing / fluid::standard_gravity);
}

Preset preset_of(double spacing, double dt) {
  Preset preset;
  preset.dt = dt;
  preset.fluid.spacing = spacing;
  return preset;
}

/// Sub-steps that a usual column of water at rest needs in a step of dt.
int parts_at_rest(const FluidSettings& fluid, double dt) {
  const double parts =
      std::ceil(dt / fluid::longest_loaded_interval(fluid, fluid::usual_layers, fluid::standard_gravity));
  return static_cast<int>(std::clamp(parts, 1.0, 999.0));
}

}  // namespace

Preset game_preset(double spacing, int steps_per_frame) {
  Preset preset = preset_of(spacing, 1.0 / 60 / std::max(1, steps_per_frame));
  preset.fluid.tolerance = 0.005;  // twice as much at rest
  preset.fluid.divergence_tolerance = 0.01;
  preset.fluid.max_iterations = 20;
  preset.fluid.cfl = 1;
  preset.fluid.max_substeps = parts_at_rest(preset.fluid, preset.dt) + 1;
  preset.contact.solver_iterations = preset.contact.ccd_iterations = 3;
  return preset;
}

Preset film_preset(double spacing) {
  // Steps, not sub-steps: cloth moves by the load of the water once a step.
  constexpr double frame = 1.0 / 24;
  Preset preset = preset_of(spacing, frame / std::ceil(frame / (0.05 * time_scale(spacing))));
  preset.fluid.max_iterations = 100;
  preset.fluid.cfl = 0.5;
  preset.fluid.max_substeps = parts_at_rest(preset.fluid, preset.dt) + 31;
  return preset;
}

Preset measurement_preset(double spacing) {
  Preset preset = preset_of(spacing, 0.02 * time_scale(spacing));
  preset.fluid.tolerance = preset.fluid.divergence_tolerance = 1e-4;
  preset.fluid.max_iterations = 500;
  preset.fluid.cfl = 0.2;
  preset.fluid.max_substeps = 100;
  preset.contact.verify = true;
  return preset;
}

}  // namespace oilskin
