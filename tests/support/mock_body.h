/// A rigid box as a SurfaceHost, in double precision: symplectic Euler, no other forces than gravity.
#pragma once

#include "core/body_path.h"
#include "oilskin/surface_motion.h"

namespace oilskin::test {

class MockBody : public SurfaceHost {
 public:
  double mass = 1;
  Vec3 half = Vec3::Constant(0.05);  ///< half of its edges [m]
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  Vec3 gravity = Vec3::Zero();
  Vec3 free_axes = Vec3::Ones();  ///< 0 = locked
  bool turns = true;              ///< moments turn it
  bool may_be_held = true;
  int held = 0;  ///< how often contact held it

  Vec3 local_inertia() const {
    const Vec3 a = 4 * half.cwiseProduct(half);
    return mass / 12 * Vec3(a.y() + a.z(), a.z() + a.x(), a.x() + a.y());
  }
  Eigen::Matrix3d inverse_inertia() const {
    return rotation * local_inertia().cwiseInverse().asDiagonal() * rotation.transpose();
  }
  Eigen::Matrix3d inertia() const { return rotation * local_inertia().asDiagonal() * rotation.transpose(); }
  Vec3 momentum() const { return mass * velocity; }
  /// About the origin.
  Vec3 angular_momentum() const { return center.cross(momentum()) + inertia() * spin; }
  double kinetic_energy() const {
    return 0.5 * mass * velocity.squaredNorm() + 0.5 * spin.dot(inertia() * spin);
  }

  Gathered gather(double dt, SurfaceMotion& m) override {
    before_ = {center, rotation};
    if (dt > 0) advance(dt);
    const std::vector<Triangle> triangles = box_triangles();
    const bool is_new = m.triangles != triangles;
    m.triangles = triangles;
    m.storage = Storage::float64;
    m.nodes_movable = false;
    m.x_t1 = corners();
    m.velocity.clear();
    for (const Vec3& x : m.x_t1) m.velocity.push_back(velocity + spin.cross(x - center));
    m.inverse_mass.assign(8, 0);
    m.holdable.assign(8, may_be_held ? 1 : 0);
    BodyMotion body;
    body.inverse_mass = free_axes / mass;
    if (turns) body.inverse_inertia = inverse_inertia();
    body.center_t1 = center;
    body.velocity = velocity;
    body.gravity = gravity;
    body.angular_velocity = spin;
    m.body = body;
    return {Status{}, is_new};
  }

  void scatter(SurfaceMotion& m) override {
    velocity += m.body->inverse_mass.cwiseProduct(m.body->impulse);
    spin += m.body->inverse_inertia * m.body->angular_impulse;
    if (m.x_t1 == corners()) return;
    ++held;
    const BodyPath path = path_of_body(m);
    const bool stands = m.x_t1 == m.x_t0;
    center = stands ? before_.first : path.end_of(before_.first);
    rotation = stands ? before_.second : Eigen::Matrix3d(path.rotation * before_.second);
  }

 private:
  void advance(double dt) {
    velocity += dt * free_axes.cwiseProduct(gravity);
    center += dt * velocity;
    const double angle = dt * spin.norm();
    if (angle > 0) rotation = Eigen::AngleAxisd(angle, spin.normalized()).toRotationMatrix() * rotation;
  }
  std::vector<Vec3> corners() const {
    std::vector<Vec3> x;
    for (int c = 0; c < 8; ++c)
      x.push_back(center + rotation * Vec3(c & 1 ? half.x() : -half.x(), c & 2 ? half.y() : -half.y(),
                                           c & 4 ? half.z() : -half.z()));
    return x;
  }
  static std::vector<Triangle> box_triangles() {
    return {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
            {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  }

  std::pair<Vec3, Eigen::Matrix3d> before_;
};

}  // namespace oilskin::test
