/// What the methods that are made of the library give to a world.
#pragma once

#include "study/comparators/coupling_method.h"

namespace oilskin::study {

inline WorldSettings world_settings(const MethodSettings& settings) {
  WorldSettings world;
  world.gravity = settings.gravity;
  world.kill_box = settings.kill_box;
  world.threads = settings.threads;
  return world;
}

inline FluidSettings fluid_settings(const MethodSettings& settings, int default_substeps) {
  FluidSettings fluid;
  fluid.spacing = settings.spacing;
  fluid.rest_density = settings.rest_density;
  fluid.viscosity = settings.viscosity;
  fluid.tolerance = settings.tolerance;
  fluid.xsph_rate = settings.xsph_rate;
  fluid.max_substeps = settings.max_substeps.value_or(default_substeps);
  return fluid;
}

}  // namespace oilskin::study
