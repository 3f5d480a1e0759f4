#include "bullet_adapter/collision_object_host.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "bullet_adapter/tessellation.h"
#include "bullet_world.h"

namespace oilskin::bullet {
namespace {

using namespace test;

const Box kill_box = {Vec3::Constant(-10), Vec3::Constant(10)};

double area(const SurfaceMotion& m) {
  double a = 0;
  for (const Triangle& t : m.triangles)
    a += 0.5 * (m.x_t1[t[1]] - m.x_t1[t[0]]).cross(m.x_t1[t[2]] - m.x_t1[t[0]]).norm();
  return a;
}

/// Positive for closed meshes whose triangles are counter-clockwise from outside.
double volume(const SurfaceMotion& m) {
  double v = 0;
  for (const Triangle& t : m.triangles) v += m.x_t1[t[0]].dot(m.x_t1[t[1]].cross(m.x_t1[t[2]])) / 6;
  return v;
}

/// Every edge of a closed mesh is used once in each direction.
bool is_closed(const SurfaceMotion& m) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> forth, back;
  for (const Triangle& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      forth.emplace_back(t[k], t[(k + 1) % 3]);
      back.emplace_back(t[(k + 1) % 3], t[k]);
    }
  std::sort(forth.begin(), forth.end());
  std::sort(back.begin(), back.end());
  return forth == back && std::adjacent_find(forth.begin(), forth.end()) == forth.end();
}

struct Object {
  btCollisionObject object;
  CollisionObjectHost host;
  SurfaceMotion motion;
  Gathered gathered;

  explicit Object(btCollisionShape* shape, const btTransform& at = btTransform::getIdentity())
      : host(place(shape, at), kill_box) {
    gathered = gather_step(host, 0, motion);
  }

 private:
  const btCollisionObject* place(btCollisionShape* shape, const btTransform& at) {
    object.setCollisionShape(shape);
    object.setWorldTransform(at);
    return &object;
  }
};

const btTransform turned(btQuaternion(btVector3(1, 2, 3).normalized(), bt(0.7)), btVector3(1, bt(-0.5), 2));
const double eps = is_double ? 1e-12 : 1e-5;

TEST(CollisionObjectHost, box_is_exact_and_closed_where_it_is) {
  btBoxShape box(btVector3(bt(0.5), 1, bt(1.5)));
  Object o(&box, turned);
  ASSERT_TRUE(o.gathered.status.ok()) << o.gathered.status.message;
  EXPECT_TRUE(o.gathered.new_surface);
  EXPECT_EQ(o.motion.triangles.size(), 12u);
  EXPECT_EQ(o.motion.x_t1.size(), 8u);
  EXPECT_TRUE(is_closed(o.motion));
  EXPECT_NEAR(volume(o.motion), 6, 50 * eps);
  EXPECT_NEAR(area(o.motion), 22, 50 * eps);
  Vec3 center = Vec3::Zero();
  for (std::size_t i = 0; i < 8; ++i) {
    center += o.motion.x_t1[i] / 8;
    EXPECT_EQ(o.motion.inverse_mass[i], 0);
    EXPECT_EQ(o.motion.holdable[i], 0);
    EXPECT_EQ(o.motion.velocity[i], Vec3(0, 0, 0));
    EXPECT_EQ(o.motion.x_t1[i], stored(o.motion.x_t1[i], bt_storage));
  }
  EXPECT_LT((center - Vec3(1, -0.5, 2)).norm(), 10 * eps);
  EXPECT_FALSE(gather_step(o.host, 0.1, o.motion).new_surface);
}

TEST(CollisionObjectHost, sphere_has_the_volume_of_the_ball) {
  btSphereShape sphere(bt(0.3));
  Object o(&sphere, turned);
  ASSERT_TRUE(o.gathered.status.ok());
  EXPECT_EQ(o.motion.triangles.size(), 1280u);
  EXPECT_EQ(o.motion.x_t1.size(), 642u);
  EXPECT_TRUE(is_closed(o.motion));
  const double ball = 4.0 / 3 * 3.14159265358979 * 0.027;
  EXPECT_NEAR(volume(o.motion), ball, 20 * eps * ball);
  const Vec3 c = to_vec3(turned.getOrigin());
  for (const Triangle& t : o.motion.triangles) {
    const Vec3 a = o.motion.x_t1[t[0]] - c, b = o.motion.x_t1[t[1]] - c, d = o.motion.x_t1[t[2]] - c;
    EXPECT_GT(std::abs((b - a).cross(d - a).normalized().dot(a)), 0.3 * 0.998);
    EXPECT_LT(a.norm(), 0.3 * 1.003);
  }
}

TEST(CollisionObjectHost, hull_keeps_the_users_points_and_scaling) {
  btConvexHullShape hull;
  for (int i = 0; i < 8; ++i)
    hull.addPoint(btVector3(bt(i & 1 ? 0.1 : -0.3), bt(i & 2 ? 0.7 : -0.1), bt(i & 4 ? 0.2 : -0.2)));
  hull.addPoint(btVector3(0, bt(0.1), 0));  // inside
  hull.setLocalScaling(btVector3(2, 1, 1));
  Object o(&hull);
  ASSERT_TRUE(o.gathered.status.ok()) << o.gathered.status.message;
  EXPECT_EQ(o.motion.x_t1.size(), 8u);
  EXPECT_TRUE(is_closed(o.motion));
  EXPECT_NEAR(volume(o.motion), 0.8 * 0.8 * 0.4, eps);
  for (const Vec3& x : o.motion.x_t1)
    EXPECT_TRUE(x.x() == 2 * double(bt(0.1)) || x.x() == -2 * double(bt(0.3)));
}

TEST(CollisionObjectHost, convex_shapes_and_their_compounds_are_solid) {
  btBoxShape box(btVector3(1, 1, 1));
  btSphereShape sphere(1);
  btStaticPlaneShape plane(btVector3(0, 1, 0), 0);
  btTriangleMesh triangles;
  for (int i = 0; i < 2; ++i)
    triangles.addTriangle(btVector3(0, bt(i), 0), btVector3(1, bt(i), 0), btVector3(0, bt(i), 1));
  btBvhTriangleMeshShape mesh(&triangles, false);
  btCompoundShape solid, mixed;
  solid.addChildShape(turned, &box);
  solid.addChildShape(btTransform::getIdentity(), &sphere);
  mixed.addChildShape(turned, &box);
  mixed.addChildShape(turned, &mesh);
  for (btCollisionShape* shape :
       {static_cast<btCollisionShape*>(&box), static_cast<btCollisionShape*>(&sphere),
        static_cast<btCollisionShape*>(&solid)})
    EXPECT_TRUE(Object(shape).motion.solid) << shape->getName();
  for (btCollisionShape* shape :
       {static_cast<btCollisionShape*>(&plane), static_cast<btCollisionShape*>(&mesh),
        static_cast<btCollisionShape*>(&mixed)})
    EXPECT_FALSE(Object(shape).motion.solid) << shape->getName();
}

TEST(CollisionObjectHost, flat_and_empty_shapes_are_refused_by_name) {
  btConvexHullShape flat;
  for (int i = 0; i < 4; ++i) flat.addPoint(btVector3(bt(i & 1), 0, bt(i & 2)));
  EXPECT_NE(Object(&flat).gathered.status.message.find("Convex"), std::string::npos);
  btCompoundShape empty;
  EXPECT_FALSE(Object(&empty).gathered.status.ok());
  btTriangleMesh none;
  btCollisionObject no_shape;
  SurfaceMotion motion;
  EXPECT_FALSE(CollisionObjectHost(&no_shape, kill_box).gather(0, motion).status.ok());
}

TEST(CollisionObjectHost, other_convex_shapes_are_the_hull_of_their_points) {
  btCapsuleShape capsule(bt(0.2), bt(0.5));
  btCylinderShape cylinder(btVector3(bt(0.3), bt(0.5), bt(0.3)));
  const double pi = 3.14159265358979;
  Object a(&capsule), b(&cylinder);
  ASSERT_TRUE(a.gathered.status.ok() && b.gathered.status.ok());
  EXPECT_TRUE(is_closed(a.motion));
  EXPECT_NEAR(volume(a.motion), pi * 0.04 * 0.5 + 4.0 / 3 * pi * 0.008, 0.02 * volume(a.motion));
  EXPECT_NEAR(volume(b.motion), pi * 0.09, 0.05 * volume(b.motion));
}

btTriangleMesh soup_of_a_quad() {
  btTriangleMesh mesh(true, false);  // no welding: six vertices
  const btVector3 a(0, 0, 0), b(2, 0, 0), c(2, 0, 1), d(0, 0, 1);
  mesh.addTriangle(a, c, b);
  mesh.addTriangle(a, d, c);
  return mesh;
}

TEST(CollisionObjectHost, triangle_mesh_is_welded_scaled_and_placed) {
  btTriangleMesh mesh = soup_of_a_quad();
  btBvhTriangleMeshShape shape(&mesh, true);
  shape.setLocalScaling(btVector3(3, 1, 1));
  Object o(&shape, turned);
  ASSERT_TRUE(o.gathered.status.ok()) << o.gathered.status.message;
  EXPECT_EQ(o.motion.triangles.size(), 2u);
  EXPECT_EQ(o.motion.x_t1.size(), 4u);
  EXPECT_NEAR(area(o.motion), 6, 20 * eps);
  const Vec3 corner = o.motion.x_t1[o.motion.triangles[0][1]];
  EXPECT_LT((corner - to_vec3(turned * btVector3(6, 0, 1))).norm(), eps);
  btScaledBvhTriangleMeshShape scaled(&shape, btVector3(1, 1, 2));
  EXPECT_NEAR(area(Object(&scaled).motion), 2 * 6, 20 * eps);
}

TEST(CollisionObjectHost, heightfields_list_their_triangles) {
  const std::vector<btScalar> heights(25, bt(0.5));  // Bullet reads btScalar where it says PHY_FLOAT
  btHeightfieldTerrainShape field(5, 5, static_cast<const void*>(heights.data()), 1, 0, 1, 1, PHY_FLOAT,
                                  false);
  Object o(&field);
  ASSERT_TRUE(o.gathered.status.ok()) << o.gathered.status.message;
  EXPECT_EQ(o.motion.triangles.size(), 32u);
  EXPECT_NEAR(area(o.motion), 16, 1e-4);
}

TEST(CollisionObjectHost, plane_is_its_part_inside_the_kill_box) {
  btStaticPlaneShape floor(btVector3(0, 1, 0), bt(0.5));
  Object level(&floor);
  ASSERT_TRUE(level.gathered.status.ok());
  EXPECT_NEAR(area(level.motion), 400, 0.01);
  for (const Vec3& x : level.motion.x_t1) {
    EXPECT_EQ(x.y(), 0.5);
    EXPECT_TRUE(kill_box.contains(x));
  }
  btStaticPlaneShape tilted(btVector3(1, 1, 1).normalized(), 0);
  Object hexagon(&tilted, btTransform(btQuaternion::getIdentity(), btVector3(0, 1, 0)));
  ASSERT_TRUE(hexagon.gathered.status.ok());
  EXPECT_EQ(hexagon.motion.x_t1.size(), 6u);
  for (const Vec3& x : hexagon.motion.x_t1) {
    EXPECT_NEAR(x.sum(), 1, 1e-4);
    EXPECT_TRUE(kill_box.contains(x));
  }
  btStaticPlaneShape outside(btVector3(0, 1, 0), 11);
  EXPECT_NE(Object(&outside).gathered.status.message.find("kill box"), std::string::npos);
}

TEST(CollisionObjectHost, clipped_planes_of_all_tilts_cover_the_box) {
  // Every point of the plane in the box lies in one of the triangles: areas of the fan and of a fine grid
  // agree.
  for (int i = 0; i < 40; ++i) {
    const Vec3 n = Vec3(std::cos(i * 1.1), std::sin(i * 2.3), std::cos(i * 0.7 + 1)).normalized();
    const double c = std::sin(i * 3.1);
    const Box box = {Vec3(-1, -2, -1.5), Vec3(2, 1, 1)};
    const PointMesh polygon = clipped_plane(n, c, box);
    SurfaceMotion motion;
    motion.x_t1 = polygon.points;
    motion.triangles = polygon.triangles;
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    std::size_t inside = 0;
    for (int a = -200; a < 200; ++a)
      for (int b = -200; b < 200; ++b)
        inside += box.contains(Vec3(c * n + (a + 0.5) * 0.03 * u + (b + 0.5) * 0.03 * v));
    EXPECT_NEAR(area(motion), 0.0009 * double(inside), 0.15) << i;
  }
}

TEST(CollisionObjectHost, compounds_are_their_children_planes_included) {
  btBoxShape box(btVector3(1, 1, 1));
  btSphereShape sphere(1);
  btStaticPlaneShape plane(btVector3(0, 1, 0), 0);
  btCompoundShape inner, outer;
  inner.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(3, 0, 0)), &sphere);
  outer.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(-3, 0, 0)), &box);
  outer.addChildShape(turned, &inner);
  outer.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(0, -4, 0)), &plane);
  Object o(&outer);
  ASSERT_TRUE(o.gathered.status.ok()) << o.gathered.status.message;
  EXPECT_EQ(o.motion.triangles.size(), 12u + 1280u + 2u);
  EXPECT_EQ(o.motion.x_t1.size(), 8u + 642u + 4u);
  EXPECT_EQ(o.motion.x_t1.back().y(), -4);
  outer.removeChildShapeByIndex(0);
  EXPECT_TRUE(gather_step(o.host, 0.1, o.motion).new_surface);
}

TEST(CollisionObjectHost, kinematic_motion_gives_velocities) {
  btBoxShape box(btVector3(1, 1, 1));
  Object o(&box);
  const double dt = 0.01;
  o.object.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, bt(0.02), 0)));
  ASSERT_FALSE(gather_step(o.host, dt, o.motion).new_surface);
  for (const Vec3& v : o.motion.velocity) EXPECT_LT((v - Vec3(0, 2, 0)).norm(), 1e-4);
  o.host.scatter(o.motion);
  ASSERT_FALSE(gather_step(o.host, dt, o.motion).new_surface);
  for (const Vec3& v : o.motion.velocity) EXPECT_EQ(v, Vec3(0, 0, 0));
  // Turning: the chord of the motion, not the tangent.
  const double angle = 0.1;
  o.object.setWorldTransform(
      btTransform(btQuaternion(btVector3(0, 1, 0), bt(angle)), btVector3(0, bt(0.02), 0)));
  ASSERT_FALSE(gather_step(o.host, dt, o.motion).new_surface);
  for (const Vec3& v : o.motion.velocity)
    EXPECT_NEAR(v.norm(), 2 * std::sqrt(2) * std::sin(angle / 2) / dt, 1e-3);
  // A teleport has none.
  o.object.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 5, 0)));
  o.host.forget_motion();
  ASSERT_TRUE(gather_step(o.host, dt, o.motion).status.ok());
  for (const Vec3& v : o.motion.velocity) EXPECT_EQ(v, Vec3(0, 0, 0));
}

TEST(CollisionObjectHost, scaling_while_attached_is_motion) {
  btBoxShape box(btVector3(1, 1, 1));
  Object o(&box);
  box.setLocalScaling(btVector3(1, 2, 1));
  ASSERT_FALSE(gather_step(o.host, 1, o.motion).new_surface);
  EXPECT_NEAR(volume(o.motion), 16, 50 * eps);
}

TEST(CollisionObjectHost, an_object_gets_no_impulses) {
  btBoxShape box(btVector3(1, 1, 1));
  Object o(&box);
  const auto x = o.motion.x_t1;
  o.motion.impulse[0] = Vec3(1, 2, 3);
  o.motion.x_t1[0] += Vec3(1, 0, 0);
  o.motion.moved[0] = 1;
  o.host.scatter(o.motion);
  EXPECT_EQ(o.motion.x_t1, x);
}

TEST(CollisionObjectHost, transforms_that_are_not_finite_are_refused_and_may_recover) {
  btBoxShape box(btVector3(1, 1, 1));
  Object o(&box);
  btTransform bad = btTransform::getIdentity();
  bad.setOrigin(btVector3(std::numeric_limits<btScalar>::quiet_NaN(), 0, 0));
  o.object.setWorldTransform(bad);
  EXPECT_FALSE(gather_step(o.host, 0.1, o.motion).status.ok());
  o.object.setWorldTransform(btTransform::getIdentity());
  EXPECT_TRUE(gather_step(o.host, 0.1, o.motion).status.ok());
  EXPECT_NEAR(volume(o.motion), 8, 50 * eps);
}

}  // namespace
}  // namespace oilskin::bullet
