/// The triangles of a Bullet collision shape.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btTransform.h>

#include "oilskin/surface_motion.h"

namespace oilskin::bullet {

/// A shape in its body's frame: what moves with the body, and planes, whose part inside the kill box depends
/// on where the body is.
struct ShapeMesh {
  struct Plane {
    btVector3 normal;
    btScalar constant;  ///< normal·x = constant
  };
  std::vector<btVector3> vertices;  ///< coincident ones welded
  std::vector<Triangle> triangles;
  std::vector<Plane> planes;
};

/// Triangle meshes (any concave shape that lists its triangles), convex hulls, boxes and tetrahedra exactly,
/// without the collision margin where Bullet adds one outside; spheres circumscribed (tessellation.h); other
/// convex shapes (capsule, cylinder, cone, …) as the hull of 642 of their surface points, inscribed, margin
/// included; static planes; compounds of these. Scaling is the shape's. Refuses what has no triangles, naming
/// the shape.
Status read_shape(const btCollisionShape& shape, ShapeMesh* mesh);

/// Changes when the shape has to be read again: another shape, another scaling or margin, children added,
/// removed or moved. Not when somebody writes into the vertex array of a triangle mesh.
std::vector<double> shape_signature(const btCollisionShape& shape);

}  // namespace oilskin::bullet
