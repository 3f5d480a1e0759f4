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
/// `levels` times (10 · 4^levels + 2 points).
PointMesh icosphere(int levels);

/// The level of an icosphere, 1 … 3, of which no triangle is farther than `tolerance` from a sphere of the
/// radius. 3 where none is so near: 642 points, 1280 triangles, less than 1 % of the radius.
int sphere_levels(double radius, double tolerance);

/// The triangles touch the sphere from outside, so that no fluid enters the ball that is drawn.
PointMesh circumscribed_sphere(double radius, int levels);

/// The convex hull; its corners are points of the input bit for bit. No triangles for points in a plane.
PointMesh convex_hull(const btAlignedObjectArray<btVector3>& points);

/// The part of the plane n·x = c, |n| = 1, that lies in the box: a convex polygon as a fan, or nothing.
PointMesh clipped_plane(const Vec3& normal, double constant, const Box& box);

}  // namespace oilskin::bullet
