/// A tank as one surface, and as boxes.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

/// The faces of the box but the open one, two triangles each, with shared corners and normals that point
/// inwards.
Mesh tank_mesh(const TankShape& tank);

/// A box outside each face but the open one, as thick as given [m]. At edges they overlap.
std::vector<BoxShape> tank_walls(const TankShape& tank, double thickness);

}  // namespace oilskin::demo
