/// Options of a reconstruction from the settings of a scene.
#pragma once

#include <string>

#include "oilskin/reconstruction.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Accepted, or which setting is wrong, in metres.
Status check_mesh_settings(const WaterMeshSettings& wanted, double spacing);

/// Spacing in metres.
ReconstructionOptions reconstruction_options(const WaterMeshSettings& wanted, double spacing, int threads);

/// The options that make the mesh, as one line of JSON; equal for equal meshes of equal frames.
std::string made_with(const WaterMeshSettings& wanted, double spacing);

}  // namespace oilskin::demo
