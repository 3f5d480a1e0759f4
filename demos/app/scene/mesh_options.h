/// Options of a reconstruction from the settings of a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "oilskin/reconstruction.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// The files of a water mesh, by the ends of their names.
const std::vector<std::string>& known_formats();

/// Quantities that the vertices of these files may have (output/vertex_channels.h).
const std::vector<std::string>& known_channels();

/// Accepted, or which setting is wrong, in metres.
Status check_mesh_settings(const WaterMeshSettings& wanted, double spacing);

/// Spacing in metres.
ReconstructionOptions reconstruction_options(const WaterMeshSettings& wanted, double spacing, int threads);

/// The options that make the mesh, as one line of JSON; equal for equal meshes of equal frames.
/// Formats are no part of it, and channels only where they are not the default: files of earlier versions
/// have neither.
/// `density`: of --density [kg/m³], if it is given.
std::string made_with(const WaterMeshSettings& wanted, double spacing, std::optional<double> density = {});

}  // namespace oilskin::demo
