/// Shapes of water and sheets that several validation cases share.
#pragma once

#include <array>

#include "scene/scene.h"

namespace oilskin::demo {

/// A point of the plane x, y [m].
using Point2 = std::array<double, 2>;

/// The boxes of water at rest that fill `outer` except `hole`, a box inside it.
std::vector<Emitter> water_around(const Box& outer, const Box& hole);

/// The strip that a line of the plane x, y sweeps from z0 to z1 [m], of `cells` cells along z.
Mesh swept_sheet(const std::vector<Point2>& line, double z0, double z1, int cells);
/// The closed prism between z0 and z1 [m] over a polygon that runs counterclockwise.
Mesh prism_mesh(const std::vector<Point2>& polygon, double z0, double z1);
/// Water at rest that fills a closed mesh.
PlacedMeshEmitter water_in(Mesh mesh);

/// A sphere of 6 n² squares, the faces of a cube carried to it; its front is outside.
Mesh ball_mesh(const Vec3& center, double radius, int n);

/// Cloth of a mesh without pins.
Cloth mesh_cloth(Mesh mesh, double areal_density);
/// Pins all nodes that start within a box.
void pin(Cloth& cloth, const Box& within);

}  // namespace oilskin::demo
