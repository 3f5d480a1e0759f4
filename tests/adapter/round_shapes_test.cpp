// How finely round shapes are divided: by their size in spacings of the water.
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bullet_adapter/shape_mesh.h"
#include "bullet_adapter/tessellation.h"
#include "bullet_world.h"
#include "oilskin/bullet.h"

namespace oilskin::bullet {
namespace {

using namespace test;

std::size_t triangles_of(const btCollisionShape& shape, double tolerance) {
  ShapeMesh mesh;
  EXPECT_TRUE(read_shape(shape, &mesh, tolerance).ok());
  return mesh.triangles.size();
}

TEST(RoundShapes, are_as_near_as_the_tolerance_asks) {
  for (const double tolerance : {0.03, 0.008, 0.004, 0.002, 0.001}) {
    const PointMesh mesh = sphere_of_equal_volume(0.2, tolerance);
    double volume = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
      EXPECT_GE((b - a).cross(c - a).normalized().dot(a), 0.2 - 0.5 * tolerance) << "outwards, and not deep";
      EXPECT_LE(a.norm(), 0.2 + tolerance);
      volume += a.dot(b.cross(c)) / 6;
    }
    EXPECT_NEAR(volume, 4 * std::acos(-1.0) / 3 * 0.008, 1e-12) << "what the ball displaces";
    EXPECT_EQ(mesh.triangles.size(), 2 * mesh.points.size() - 4) << "closed (Euler)";
  }
  EXPECT_EQ(triangles_of(btSphereShape(bt(0.2)), 0.01), 80u);
  EXPECT_EQ(triangles_of(btSphereShape(bt(0.2)), 0.008), 180u);
  EXPECT_EQ(triangles_of(btSphereShape(bt(0.2)), 0.002), 500u);
  EXPECT_EQ(triangles_of(btSphereShape(bt(0.2)), 0), 1280u);
  const btCapsuleShape capsule(bt(0.05), bt(0.1));
  EXPECT_LT(2 * triangles_of(capsule, 0.01), triangles_of(capsule, 0));
}

struct Ball {
  btSphereShape shape{bt(0.05)};
  btCollisionObject object;
  Ball() { object.setCollisionShape(&shape); }
};

std::size_t triangles_in(const btFluidCoupling& coupling, const Ball& ball) {
  const SurfaceMotion* surface = coupling.getSurface(&ball.object);
  return surface ? surface->triangles.size() : 0;
}

TEST(RoundShapes, follow_the_finest_fluid) {
  Ball ball;
  btFluid coarse(bt(0.1)), medium(bt(0.015)), fine(bt(0.005));
  btFluidCoupling coupling(&coarse);
  ASSERT_TRUE(coupling.addCollisionObject(&ball.object).ok());
  EXPECT_EQ(triangles_in(coupling, ball), 80u);
  ASSERT_TRUE(coupling.addFluid(&medium).ok());
  ASSERT_TRUE(coupling.step(bt(0.001)).status.ok());
  EXPECT_EQ(triangles_in(coupling, ball), 180u);
  ASSERT_TRUE(coupling.addFluid(&fine).ok());
  ASSERT_TRUE(coupling.step(bt(0.001)).status.ok());
  EXPECT_EQ(triangles_in(coupling, ball), 500u);
  coupling.removeFluid(&fine);
  ASSERT_TRUE(coupling.step(bt(0.001)).status.ok());
  EXPECT_EQ(triangles_in(coupling, ball), 500u) << "water would be inside a coarser ball";
}

// Water on a ball that gets more triangles stays outside of it.
TEST(RoundShapes, let_nothing_in_where_they_get_finer) {
  Ball ball;
  btFluid coarse(bt(0.1)), fine(bt(0.01));
  btFluidCoupling coupling(&coarse);
  SurfaceSettings settings;
  settings.thickness = 0.002;
  ASSERT_TRUE(coupling.addCollisionObject(&ball.object, settings).ok());
  ASSERT_TRUE(coarse.addBox({bt(-0.3), bt(0.06), bt(-0.3)}, {bt(0.3), bt(0.3), bt(0.3)}).ok());
  for (int k = 0; k < 20; ++k) {
    if (k == 10) {
      ASSERT_TRUE(coupling.addFluid(&fine).ok());
    }
    ASSERT_TRUE(coupling.step(bt(0.005)).status.ok());
    ASSERT_GT(coarse.getNumParticles(), 20);
    for (const Vec3& x : coarse.getWorld().positions()) EXPECT_GE(x.norm(), 0.05) << "step " << k;
  }
}

}  // namespace
}  // namespace oilskin::bullet
