/// Triangles for shapes that have none.
#pragma once

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btVector3.h>

#include "oilskin/types.h"

namespace oilskin::bullet {

struct PointMesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;  ///< counter-clockwise from outside
};

/// Unit directions that cover the sphere evenly and the triangles between them: an icosahedron whose
/// triangles were quartered `levels` times (10 · 4^levels + 2 points).
PointMesh icosphere(int levels);

/// A sphere's mesh is circumscribed: its triangles touch the sphere from outside, so that no fluid enters the
/// ball that is drawn. At the level used (3: 642 points, 1280 triangles) corners stand out by less than 1 %
/// of r.
PointMesh circumscribed_sphere(double radius);

/// The hull of points; its corners are points of the input bit for bit. Flat or smaller input gives no
/// triangles.
PointMesh convex_hull(const btAlignedObjectArray<btVector3>& points);

/// The part of the plane n·x = c, |n| = 1, that lies in the box: a convex polygon as a fan, or nothing.
PointMesh clipped_plane(const Vec3& normal, double constant, const Box& box);

}  // namespace oilskin::bullet
