/// The options of a reconstruction from what a scene says of its water's surface.
#pragma once

#include <string>

#include "oilskin/reconstruction.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Accepted, or what is wrong, in metres.
Status check_water_surface(const WaterSurface& wanted, double spacing);

/// Spacing in metres.
ReconstructionOptions surface_options(const WaterSurface& wanted, double spacing, int threads);

/// The options that make the mesh, as one line of JSON; equal for equal meshes of equal frames.
std::string made_with(const WaterSurface& wanted, double spacing);

}  // namespace oilskin::demo
