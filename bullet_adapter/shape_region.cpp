#include "shape_region.h"

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>
#include <cmath>

#include "convert.h"
#include "core/box_around.h"
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

Eigen::Matrix3d basis_of(const btTransform& transform) {
  Eigen::Matrix3d basis;
  for (int row = 0; row < 3; ++row) basis.row(row) = to_vec3(transform.getBasis().getRow(row));
  return basis;
}

std::optional<Eigen::Affine3d> inverse_of(const btTransform& transform) {
  const Eigen::Matrix3d basis = basis_of(transform);
  const Eigen::Matrix3d inverse = basis.inverse();
  const Vec3 origin = inverse * to_vec3(transform.getOrigin());
  if (!basis.allFinite() || !inverse.allFinite() || !origin.allFinite()) return {};
  Eigen::Affine3d to_local;
  to_local.linear() = inverse;
  to_local.translation() = -origin;
  return to_local;
}

Status check_rigid(const btTransform& transform, const char* what) {
  const Eigen::Matrix3d basis = basis_of(transform);
  if (!basis.allFinite() || !to_vec3(transform.getOrigin()).allFinite())
    return Status::refused(std::string(what) + " is not finite");
  if (!(basis * basis.transpose()).isIdentity(1e-3) || basis.determinant() < 0)
    return Status::refused(std::string(what) + " scales or mirrors; it must turn and shift only");
  return Status::accepted();
}

Status read_pose(const btTransform& transform, EmitterPose* pose) {
  if (Status s = check_rigid(transform); !s.ok()) return s;
  pose->position = to_vec3(transform.getOrigin());
  pose->rotation = Rotation(basis_of(transform)).normalized();
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

std::optional<ConvexRegion> ConvexRegion::of(const btConvexShape& shape) {
  ConvexRegion found;
  const int type = shape.getShapeType();
  if (type == SPHERE_SHAPE_PROXYTYPE) {
    found.set_round(static_cast<double>(static_cast<const btSphereShape&>(shape).getRadius()), 0, 1);
  } else if (type == CAPSULE_SHAPE_PROXYTYPE) {
    const auto& capsule = static_cast<const btCapsuleShape&>(shape);
    found.set_round(static_cast<double>(capsule.getRadius()), static_cast<double>(capsule.getHalfHeight()),
                    capsule.getUpAxis());
  } else if (!found.set_planes(shape)) {
    return {};
  }
  const auto& round = found.region_.capsule;
  if (round && !(std::isfinite(round->radius) && round->to.allFinite())) return {};
  return found;
}

void ConvexRegion::set_round(double radius, double half_length, int axis) {
  const Vec3 end = half_length * Vec3::Unit(axis);
  region_.capsule = Capsule{-end, end, radius};
}

bool ConvexRegion::set_planes(const btConvexShape& shape) {
  ShapeMesh mesh;
  if (!read_shape(shape, &mesh).ok()) return false;
  Box& box = region_.box.emplace();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) box.add(to_vec3(mesh.vertices[i]));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = to_vec3(mesh.vertices[t[0]]), b = to_vec3(mesh.vertices[t[1]]),
               c = to_vec3(mesh.vertices[t[2]]);
    region_.half_spaces.push_back({a, (b - a).cross(c - a)});
  }
  return true;
}

/// Cuts the segment at each plane.
bool ConvexRegion::meets(const Vec3& a, const Vec3& b) const {
  if (const auto& round = region_.capsule) return distance(a, b, round->from, round->to) <= round->radius;
  Box around;
  around.add(a);
  around.add(b);
  if (!region_.box->overlaps(around)) return false;
  double enters = 0, leaves = 1;
  for (const HalfSpace& half : region_.half_spaces) {
    const double at_a = half.normal.dot(a - half.point), at_b = half.normal.dot(b - half.point);
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

/// A little larger, for the rounding of positions in the frames of the parts.
Box ShapeRegion::bounds() const {
  Box all;
  for (const Part& part : parts_) {
    const Eigen::Affine3d to_shape = part.to_local.inverse();
    all.add(box_around(*part.region.region().bounds(), [&](const Vec3& x) { return Vec3(to_shape * x); }));
  }
  return all.inflated(1e-9 * (all.max - all.min).norm());
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
