/// Triangle meshes for shapes that are not meshes.
#pragma once

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btVector3.h>

#include "oilskin/types.h"

namespace oilskin::bullet {

struct PointMesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;  ///< counter-clockwise from outside
};

/// Evenly distributed unit directions and their triangles: an icosahedron whose triangles are divided in four
/// one to three times (42, 162 or 642 points), the fewest of which none is farther than `tolerance` from a
/// sphere of the radius that they touch from outside. 642, less than 1 % of the radius, where none are so
/// near.
PointMesh icosphere(double radius, double tolerance);

/// The same around a sphere of the radius: no fluid enters the ball that is drawn.
PointMesh circumscribed_sphere(double radius, double tolerance);

/// The convex hull; its corners are points of the input bit for bit. No triangles for points in a plane.
PointMesh convex_hull(const btAlignedObjectArray<btVector3>& points);

/// The part of the plane n·x = c, |n| = 1, that lies in the box: a convex polygon as a fan, or nothing.
PointMesh clipped_plane(const Vec3& normal, double constant, const Box& box);

}  // namespace oilskin::bullet
