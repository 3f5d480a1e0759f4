/// A tank as one surface.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

/// The faces of the box but the open one, two triangles each, with shared corners and normals that point
/// inwards.
Mesh tank_mesh(const TankShape& tank);

}  // namespace oilskin::demo
