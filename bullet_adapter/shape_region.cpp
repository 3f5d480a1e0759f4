#include "shape_region.h"

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>
#include <cmath>

#include "convert.h"
#include "shape_mesh.h"

namespace oilskin::bullet {

namespace {

/// The distance of the segments a b and p q, by their closest points [Ericson2005, 5.1.9].
double distance(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const Vec3 u = b - a, v = q - p, r = a - p;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), ur = u.dot(r), vr = v.dot(r), uv = u.dot(v);
  const auto clamped = [](double t) { return std::clamp(t, 0.0, 1.0); };
  double s = 0, t = 0;
  if (uu == 0) {
    t = vv > 0 ? clamped(vr / vv) : 0;
  } else if (vv == 0) {
    s = clamped(-ur / uu);
  } else {
    const double determinant = uu * vv - uv * uv;
    s = determinant > 0 ? clamped((uv * vr - ur * vv) / determinant) : 0;
    t = clamped((uv * s + vr) / vv);
    s = clamped((uv * t - ur) / uu);
  }
  return (a + s * u - p - t * v).norm();
}

}  // namespace

std::optional<Eigen::Affine3d> inverse_of(const btTransform& transform) {
  Eigen::Matrix3d basis;
  for (int row = 0; row < 3; ++row) basis.row(row) = to_vec3(transform.getBasis().getRow(row));
  const Eigen::Matrix3d inverse = basis.inverse();
  const Vec3 origin = inverse * to_vec3(transform.getOrigin());
  if (!basis.allFinite() || !inverse.allFinite() || !origin.allFinite()) return {};
  Eigen::Affine3d to_local;
  to_local.linear() = inverse;
  to_local.translation() = -origin;
  return to_local;
}

Status read_pose(const btTransform& transform, EmitterPose* pose) {
  Eigen::Matrix3d basis;
  for (int row = 0; row < 3; ++row) basis.row(row) = to_vec3(transform.getBasis().getRow(row));
  const Vec3 position = to_vec3(transform.getOrigin());
  if (!basis.allFinite() || !position.allFinite()) return Status::refused("the transform is not finite");
  if (!(basis * basis.transpose()).isIdentity(1e-3) || basis.determinant() < 0)
    return Status::refused("the transform scales or mirrors; it must turn and shift only");
  pose->position = position;
  pose->rotation = Rotation(basis).normalized();
  return Status::accepted();
}

Status read_region(const btConvexShape* shape, Region* region) {
  if (!shape) return Status::refused("the shape is null");
  const std::optional<ConvexRegion> found = ConvexRegion::of(*shape);
  if (!found) return Status::refused("the shape has no volume: it must be convex and finite");
  Region read = found->region();
  Status status = read.validate();
  if (status.ok()) *region = std::move(read);
  return status;
}

Region ConvexRegion::region() const {
  Region region;
  if (is_round_) {
    region.capsule = Capsule{-half_length_ * axis_, half_length_ * axis_, radius_};
    return region;
  }
  region.box = box_;
  region.half_spaces.reserve(planes_.size());
  for (const Plane& plane : planes_) region.half_spaces.push_back({plane.point, plane.normal});
  return region;
}

std::optional<ConvexRegion> ConvexRegion::of(const btConvexShape& shape) {
  ConvexRegion region;
  const int type = shape.getShapeType();
  if (type == SPHERE_SHAPE_PROXYTYPE) {
    region.set_round(static_cast<double>(static_cast<const btSphereShape&>(shape).getRadius()), 0,
                     Vec3::UnitY());
  } else if (type == CAPSULE_SHAPE_PROXYTYPE) {
    const auto& capsule = static_cast<const btCapsuleShape&>(shape);
    region.set_round(static_cast<double>(capsule.getRadius()), static_cast<double>(capsule.getHalfHeight()),
                     Vec3::Unit(capsule.getUpAxis()));
  } else if (!region.set_planes(shape)) {
    return {};
  }
  return std::isfinite(region.radius_ + region.half_length_) ? std::optional(region) : std::nullopt;
}

void ConvexRegion::set_round(double radius, double half_length, const Vec3& axis) {
  is_round_ = true;
  radius_ = radius;
  half_length_ = half_length;
  axis_ = axis;
}

bool ConvexRegion::set_planes(const btConvexShape& shape) {
  ShapeMesh mesh;
  if (!read_shape(shape, &mesh).ok()) return false;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) box_.add(to_vec3(mesh.vertices[i]));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = to_vec3(mesh.vertices[t[0]]), b = to_vec3(mesh.vertices[t[1]]),
               c = to_vec3(mesh.vertices[t[2]]);
    planes_.push_back({a, (b - a).cross(c - a)});
  }
  return true;
}

bool ConvexRegion::contains(const Vec3& x) const {
  if (is_round_) return (x - std::clamp(x.dot(axis_), -half_length_, half_length_) * axis_).norm() <= radius_;
  return box_.contains(x) && std::all_of(planes_.begin(), planes_.end(),
                                         [&x](const Plane& p) { return p.normal.dot(x - p.point) <= 0; });
}

/// Cuts the segment at each plane.
bool ConvexRegion::meets(const Vec3& a, const Vec3& b) const {
  if (is_round_) return distance(a, b, -half_length_ * axis_, half_length_ * axis_) <= radius_;
  Box around;
  around.add(a);
  around.add(b);
  if (!box_.overlaps(around)) return false;
  double enters = 0, leaves = 1;
  for (const Plane& plane : planes_) {
    const double at_a = plane.normal.dot(a - plane.point), at_b = plane.normal.dot(b - plane.point);
    if (at_a > 0 && at_b > 0) return false;
    if (at_a > 0) enters = std::max(enters, at_a / (at_a - at_b));
    if (at_b > 0) leaves = std::min(leaves, at_a / (at_a - at_b));
  }
  return enters <= leaves;
}

std::optional<ShapeRegion> ShapeRegion::of(const btCollisionShape& shape) {
  ShapeRegion region;
  if (!region.add(shape, Eigen::Affine3d::Identity()) || region.parts_.empty()) return {};
  return region;
}

bool ShapeRegion::add(const btCollisionShape& shape, const Eigen::Affine3d& to_local) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      const auto to_child = inverse_of(compound.getChildTransform(i));
      if (!to_child || !add(*compound.getChildShape(i), *to_child * to_local)) return false;
    }
    return true;
  }
  if (!shape.isConvex()) return false;
  const auto region = ConvexRegion::of(static_cast<const btConvexShape&>(shape));
  if (region) parts_.push_back({to_local, *region});
  return region.has_value();
}

bool ShapeRegion::contains(const Vec3& x) const {
  return std::any_of(parts_.begin(), parts_.end(),
                     [&x](const Part& part) { return part.region.contains(part.to_local * x); });
}

bool ShapeRegion::meets(const Vec3& a, const Vec3& b) const {
  return std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) {
    return part.region.meets(part.to_local * a, part.to_local * b);
  });
}

}  // namespace oilskin::bullet
