/// Bodies of a scene as Bullet's.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "scene/scene.h"

namespace oilskin::demo {

constexpr double cloth_margin = 0.005;  ///< [m]; Bullet's default of 0.25 m is made for furniture

constexpr int cloth_filter = 64;  ///< Bullet's own groups end at 32

inline btVector3 to_bullet(const Vec3& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

inline Vec3 from_bullet(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

inline btQuaternion to_bullet(const std::array<double, 4>& q) {
  return {btScalar(q[0]), btScalar(q[1]), btScalar(q[2]), btScalar(q[3])};
}

/// Owner of a Bullet body and its shape.
struct BulletBody {
  std::unique_ptr<btTriangleMesh> mesh;
  std::vector<std::unique_ptr<btCollisionShape>> parts;  ///< of a compound
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> body;
  double volume = 0;              ///< of what may be dynamic [m³]
  Vec3 origin = Vec3::Zero();     ///< of a dynamic body its centre of mass [m]
  Vec3 displaced = Vec3::Zero();  ///< by grips [m]
  btQuaternion turned{0, 0, 0, 1};
  /// With what cloth collides in place of it; null: with the body itself.
  std::unique_ptr<BulletBody> for_cloth;
};

/// A dynamic mesh is its convex hull. A tank has boxes for cloth. Throws SceneError, with the key in front,
/// for a hull without a volume.
BulletBody make_body(const Body& settings, const std::string& key);

/// Cloth is to be added with the filter group cloth_filter.
void add_body_to(btDiscreteDynamicsWorld& world, BulletBody& body);
void remove_body_from(btDiscreteDynamicsWorld& world, BulletBody& body);

void make_kinematic(BulletBody& body);
/// Where the motion has taken it at time t [s], displaced, with the velocity of the motion and `more` [m/s].
void place(BulletBody& body, const Motion& motion, double t, const Vec3& more);
/// [m/s]
void set_velocity(BulletBody& body, const Vec3& velocity);

}  // namespace oilskin::demo
