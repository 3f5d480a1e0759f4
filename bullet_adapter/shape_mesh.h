/// The triangles of a Bullet collision shape.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btTransform.h>

#include "oilskin/surface_motion.h"

namespace oilskin::bullet {

/// A shape in its body's frame: triangles, and planes, whose polygons in the kill box depend on the
/// transform.
struct ShapeMesh {
  struct Plane {
    btVector3 normal;
    btScalar constant;  ///< normal·x = constant
  };
  std::vector<btVector3> vertices;  ///< coincident ones are welded
  std::vector<Triangle> triangles;
  std::vector<Plane> planes;
  bool solid = true;  ///< its parts are convex: no triangle mesh and no plane
};

/// Reads triangle meshes (any concave shape that lists its triangles), convex hulls, boxes and tetrahedra
/// exactly, without the collision margin that Bullet adds outside; spheres with their volume; other convex
/// shapes (capsule, cylinder, cone, …) as the hull of some of their surface points, inscribed, with the
/// margin; static planes; compounds of these. `tolerance` and the size of the shape say how many points
/// spheres and such hulls have (tessellation.h). Applies the shape's scaling. Refuses shapes without
/// triangles by name.
Status read_shape(const btCollisionShape& shape, ShapeMesh* mesh, double tolerance = 0);

/// Differs if the shape must be read again: another shape, scaling or margin, children added, removed or
/// moved. Does not detect changes of the vertex array of a triangle mesh.
std::vector<double> shape_signature(const btCollisionShape& shape);

}  // namespace oilskin::bullet
