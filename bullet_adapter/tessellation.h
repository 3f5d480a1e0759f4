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

/// Evenly distributed unit directions: the points of an icosahedron whose edges are divided into n = 2 to 8
/// parts, 10 n² + 2 of them. n is the least with which triangles between points of a sphere of the radius
/// are nowhere farther than `tolerance` from it; 8 (0.5 % of the radius) where none are so near.
const std::vector<Vec3>& even_directions(double radius, double tolerance);

/// The 20 n² triangles between such directions, with the volume of the ball: what it displaces has its
/// weight. n is the least with which points lie outside the ball by `tolerance` at most; triangles lie inside
/// it by less than half of that. With n = 8, 0.3 % of the radius.
PointMesh sphere_of_equal_volume(double radius, double tolerance);

/// The convex hull; its corners are points of the input bit for bit. No triangles for points in a plane.
PointMesh convex_hull(const btAlignedObjectArray<btVector3>& points);

/// The part of the plane n·x = c, |n| = 1, that lies in the box: a convex polygon as a fan, or nothing.
PointMesh clipped_plane(const Vec3& normal, double constant, const Box& box);

}  // namespace oilskin::bullet
