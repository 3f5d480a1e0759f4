/// The points inside a Bullet collision shape.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <optional>

#include "oilskin/region.h"

namespace oilskin::bullet {

/// From the world to the frame of `transform`, in double precision; none if there is no finite one.
std::optional<Eigen::Affine3d> inverse_of(const btTransform& transform);

/// The rotation of a transform, in double precision.
Eigen::Matrix3d basis_of(const btTransform& transform);
/// Refuses a transform that is not finite, scales or mirrors. `what` stands in the message.
Status check_rigid(const btTransform& transform, const char* what = "the transform");
/// A pose from a transform that check_rigid() accepts.
Status read_pose(const btTransform& transform, EmitterPose* pose);
/// A convex shape as a region around the origin. Refuses null and shapes without a volume.
Status read_region(const btConvexShape* shape, Region* region);

/// The points of a convex shape, surface included, in the frame of its body.
class ConvexRegion {
 public:
  /// None for a shape without a volume.
  static std::optional<ConvexRegion> of(const btConvexShape& shape);

  /// The same points. A capsule, or a box around the vertices with the planes of the faces.
  const Region& region() const { return region_; }
  bool contains(const Vec3& x) const { return region_.contains(x); }
  /// Whether the segment between two points has a point of the shape.
  bool meets(const Vec3& a, const Vec3& b) const;

 private:
  void set_round(double radius, double half_length, int axis);
  bool set_planes(const btConvexShape& shape);

  Region region_;
};

/// The points of a shape: convex, or a compound of such shapes.
class ShapeRegion {
 public:
  /// None for shapes without a volume: triangle meshes, planes, and compounds that have one.
  static std::optional<ShapeRegion> of(const btCollisionShape& shape);

  /// A box that has all points of the shape.
  Box bounds() const;
  bool contains(const Vec3& x) const;
  /// Whether the segment between two points has a point of the shape.
  bool meets(const Vec3& a, const Vec3& b) const;

 private:
  struct Part {
    Eigen::Affine3d to_local;
    ConvexRegion region;
  };
  bool add(const btCollisionShape& shape, const Eigen::Affine3d& to_local);

  std::vector<Part> parts_;
};

}  // namespace oilskin::bullet
