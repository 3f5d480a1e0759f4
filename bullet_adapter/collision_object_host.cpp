#include "collision_object_host.h"

#include <utility>

#include "convert.h"
#include "tessellation.h"

namespace oilskin::bullet {

namespace {

/// With this margin the corners of a clipped plane, rounded to float, stay inside the box.
Box shrunk_by_rounding(const Box& box) {
  const Vec3 margin = 1e-6 * box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs());
  return {box.min + margin, box.max - margin};
}

bool is_finite(const btTransform& t) {
  bool finite = to_vec3(t.getOrigin()).allFinite();
  for (int row = 0; row < 3; ++row) finite = finite && to_vec3(t.getBasis().getRow(row)).allFinite();
  return finite;
}

}  // namespace

CollisionObjectHost::CollisionObjectHost(const btCollisionObject* object, const Box& kill_box)
    : object_(object), kill_box_(shrunk_by_rounding(kill_box)), transform_(btTransform::getIdentity()) {}

bool CollisionObjectHost::set_kill_box(const Box& kill_box) {
  const Box before = std::exchange(kill_box_, shrunk_by_rounding(kill_box));
  world_.clear();
  return !mesh_.planes.empty() && (before.min != kill_box_.min || before.max != kill_box_.max);
}

void CollisionObjectHost::set_tolerance(double tolerance) {
  if (tolerance_ > 0 && tolerance >= tolerance_) return;
  tolerance_ = tolerance;
  signature_.clear();
}

Status CollisionObjectHost::read_if_changed() {
  const btCollisionShape* shape = object_->getCollisionShape();
  if (!shape)
    return Status::refused("collision object has no collision shape: call setCollisionShape() first");
  std::vector<double> signature = shape_signature(*shape);
  if (!forget_motion_ && signature == signature_) return Status::accepted();
  Status status = read_shape(*shape, &mesh_, tolerance_);
  world_.clear();  // stale
  if (status.ok()) signature_ = std::move(signature);
  return status;
}

/// World positions and triangles: the polygon of a plane depends on the transform.
Status CollisionObjectHost::update_positions(const btTransform& transform) {
  if (!world_.empty() && transform == transform_) return Status::accepted();
  if (!is_finite(transform)) return Status::refused("collision object has a transform that is not finite");
  transform_ = transform;
  world_.clear();
  ++revision_;
  for (const btVector3& v : mesh_.vertices) world_.push_back(to_vec3(transform * v));
  triangles_ = mesh_.triangles;
  for (const ShapeMesh::Plane& plane : mesh_.planes) {
    const Vec3 n = to_vec3(transform.getBasis() * plane.normal);
    const double c = static_cast<double>(plane.constant) + n.dot(to_vec3(transform.getOrigin()));
    const PointMesh polygon = clipped_plane(n.normalized(), c / n.norm(), kill_box_);
    const auto first = static_cast<std::uint32_t>(world_.size());
    for (const Vec3& p : polygon.points) world_.push_back(stored(p, bt_storage));
    for (const Triangle& t : polygon.triangles)
      triangles_.push_back({first + t[0], first + t[1], first + t[2]});
  }
  if (triangles_.empty())
    return Status::refused("static plane lies outside the kill box: enlarge the box or leave the plane out");
  return Status::accepted();
}

Gathered CollisionObjectHost::gather(double dt, SurfaceMotion& motion) {
  Gathered result;
  result.status = read_if_changed();
  if (result.status.ok()) result.status = update_positions(object_->getWorldTransform());
  if (!result.status.ok()) {
    signature_.clear();
    return result;
  }
  if (motion.still != 0 && motion.revision == revision_) {
    result.unchanged = true;
    return result;
  }
  const std::size_t n = world_.size();
  motion.revision = revision_;
  if (motion.triangles != triangles_ || motion.x_t1.size() != n) {
    result.new_surface = true;
    motion.triangles = triangles_;
    motion.storage = bt_storage;
    motion.nodes_movable = false;
    motion.solid = mesh_.solid;
  }
  motion.x_t1 = world_;
  motion.inverse_mass.assign(n, 0);
  motion.holdable.assign(n, 0);
  motion.velocity.resize(n);
  const double moved_for = result.new_surface || forget_motion_ ? 0 : dt;
  for (std::size_t i = 0; i < n; ++i) motion.velocity[i] = prescribed_velocity(motion, i, moved_for);
  forget_motion_ = false;
  return result;
}

void CollisionObjectHost::scatter(SurfaceMotion& motion) {
  if (motion.x_t1.size() != world_.size()) return;
  if (motion.still == 0)
    motion.x_t1 = world_;
  else
    for (std::uint32_t node : motion.touched) motion.x_t1[node] = world_[node];
}

}  // namespace oilskin::bullet
