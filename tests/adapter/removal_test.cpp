// Removal of water through btFluid, by boxes and convex shapes, and the limit of its particles.
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "audited_water.h"

namespace oilskin::bullet {
namespace {

using namespace test;

/// A cube of 20³ particles around the origin, 0.4 m wide, in no gravity.
struct Cube : btFluid {
  Cube() : btFluid(coarse_fluid(), weightless(), ContactSettings()) {
    std::vector<Vec3> x;
    x.reserve(8000);
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 20; ++j)
        for (int k = 0; k < 20; ++k) x.push_back(0.02 * (Vec3(k, j, i) - Vec3::Constant(9.5)));
    EXPECT_TRUE(getWorld().add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  }
  static WorldSettings weightless() {
    WorldSettings world = small_world();
    world.gravity.setZero();
    return world;
  }
};

/// A turn and a shift, in double precision as Bullet stored them.
struct Place {
  btTransform transform;

  Place()
      : transform(btQuaternion(btVector3(bt(0.6), bt(0.8), 0), bt(0.7)),
                  btVector3(bt(0.03), bt(-0.02), bt(0.01))) {}
  Vec3 to_local(const Vec3& x) const {
    const Vec3 d = x - to_vec3(transform.getOrigin());
    Vec3 local = Vec3::Zero();
    for (int row = 0; row < 3; ++row) local += d[row] * to_vec3(transform.getBasis().getRow(row));
    return local;
  }
};

/// `depth` > 0 inside the shape, < 0 outside [m]. Points within `unsure` [m] of the surface may be either.
void expect_to_remove(const btConvexShape& shape, const std::function<double(const Vec3&)>& depth,
                      double unsure = 1e-6) {
  Cube water;
  const Place place;
  std::set<std::uint64_t> inside, outside;
  for (int i = 0; i < water.getNumParticles(); ++i) {
    const double d = depth(place.to_local(water.getWorld().positions()[static_cast<std::size_t>(i)]));
    if (d > unsure) inside.insert(water.getId(i));
    if (d < -unsure) outside.insert(water.getId(i));
  }
  ASSERT_GT(inside.size(), 50u);
  const int removed = water.removeParticles(&shape, place.transform);
  EXPECT_EQ(removed, 8000 - water.getNumParticles());
  EXPECT_GE(removed, static_cast<int>(inside.size()));
  EXPECT_LE(removed, 8000 - static_cast<int>(outside.size()));
  std::size_t kept = 0;
  for (int i = 0; i < water.getNumParticles(); ++i) {
    EXPECT_EQ(inside.count(water.getId(i)), 0u);
    kept += outside.count(water.getId(i));
  }
  EXPECT_EQ(kept, outside.size());
}

double box_depth(const Vec3& x, const Vec3& half) {
  return (half - x.cwiseAbs()).minCoeff();
}

TEST(Removal, by_box_shape) {
  btBoxShape box(btVector3(bt(0.1), bt(0.05), bt(0.15)));
  box.setMargin(bt(0.03));
  const btVector3 half = box.getHalfExtentsWithMargin();
  expect_to_remove(box, [half](const Vec3& x) { return box_depth(x, to_vec3(half)); });
  box.setLocalScaling(btVector3(bt(0.5), 2, 1));
  const btVector3 scaled = box.getHalfExtentsWithMargin();
  expect_to_remove(box, [scaled](const Vec3& x) { return box_depth(x, to_vec3(scaled)); });
}

TEST(Removal, by_sphere_and_capsules) {
  btSphereShape sphere(bt(0.11));
  expect_to_remove(sphere, [](const Vec3& x) { return 0.11 - x.norm(); });
  const auto capsule = [](int axis) {
    return [axis](Vec3 x) {
      x[axis] -= std::min(0.06, std::max(-0.06, x[axis]));
      return 0.07 - x.norm();
    };
  };
  expect_to_remove(btCapsuleShapeX(bt(0.07), bt(0.12)), capsule(0));
  expect_to_remove(btCapsuleShape(bt(0.07), bt(0.12)), capsule(1));
  expect_to_remove(btCapsuleShapeZ(bt(0.07), bt(0.12)), capsule(2));
}

TEST(Removal, by_convex_hull_without_its_margin) {
  btConvexHullShape octahedron;
  for (int k = 0; k < 6; ++k) {
    btVector3 corner(0, 0, 0);
    corner[k % 3] = bt(k < 3 ? 0.16 : -0.16);
    octahedron.addPoint(corner);
  }
  octahedron.setMargin(bt(0.04));
  expect_to_remove(octahedron, [](const Vec3& x) { return (0.16 - x.cwiseAbs().sum()) / std::sqrt(3.0); });
}

/// The hull of 642 points lies up to a part in a hundred inside.
TEST(Removal, by_other_convex_shapes_as_the_hull_of_their_points) {
  btCylinderShape cylinder(btVector3(bt(0.1), bt(0.12), bt(0.1)));
  expect_to_remove(
      cylinder,
      [](const Vec3& x) { return std::min(0.1 - std::hypot(x.x(), x.z()), 0.12 - std::abs(x.y())); }, 1e-3);
}

TEST(Removal, by_an_axis_aligned_box) {
  Cube water;
  EXPECT_EQ(water.removeParticles({bt(-0.2), bt(-0.2), bt(-0.2)}, {bt(0.2), 0, bt(0.2)}), 4000);
  EXPECT_EQ(water.getNumParticles(), 4000);
  for (int i = 0; i < 4000; ++i) ASSERT_GT(water.getPosition(i).y(), 0);
  const double m = water.getWorld().particle_mass();
  EXPECT_NEAR(static_cast<double>(water.getMass()), 4000 * m, 1e-6 * 4000 * m);
  EXPECT_NEAR(static_cast<double>(water.getVolume()), 4 * m, 1e-6 * 4 * m);
  EXPECT_EQ(water.removeParticles({1, 1, 1}, {bt(1.5), bt(1.5), bt(1.5)}), 0);
}

TEST(Removal, refuses_what_makes_no_sense) {
  Cube water;
  const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
  const btScalar inf = std::numeric_limits<btScalar>::infinity();
  EXPECT_EQ(water.removeParticles({1, 0, 0}, {0, 1, 1}), -1);
  EXPECT_EQ(water.removeParticles({nan, 0, 0}, {1, 1, 1}), -1);
  EXPECT_EQ(water.removeParticles({-inf, -inf, -inf}, {inf, inf, inf}), -1);
  const btTransform here = btTransform::getIdentity();
  EXPECT_EQ(water.removeParticles(nullptr, here), -1);
  btSphereShape sphere(1);
  EXPECT_EQ(water.removeParticles(&sphere, btTransform(btMatrix3x3::getIdentity(), {nan, 0, 0})), -1);
  EXPECT_EQ(water.removeParticles(&sphere, btTransform(btMatrix3x3(0, 0, 0, 0, 0, 0, 0, 0, 0))), -1);
  btSphereShape endless(inf), nowhere(nan);
  EXPECT_EQ(water.removeParticles(&endless, here), -1);
  EXPECT_EQ(water.removeParticles(&nowhere, here), -1);
  btTriangleShape flat({-1, 0, -1}, {1, 0, -1}, {0, 0, 1});
  flat.setMargin(0);
  EXPECT_EQ(water.removeParticles(&flat, here), -1);
  btConvexHullShape empty;
  EXPECT_EQ(water.removeParticles(&empty, here), -1);
  EXPECT_EQ(water.getNumParticles(), 8000);
}

TEST(Removal, nothing_crosses_cloth_whose_water_is_taken_away) {
  LedgerSolver solver;
  SoftWorld bullet(down, &solver);
  AuditedWater water;
  ASSERT_TRUE(solver.addFluid(&water).ok());
  btSoftBody* cloth = bullet.patch(13, 0.4, 0, 0, 0.2);
  pin_border(cloth, 13);
  ASSERT_TRUE(solver.addCloth(cloth, bt(sheet_thickness)).ok());
  ASSERT_TRUE(water.addJet({0, bt(0.15), 0}, {0, -1, 0}, 2, bt(0.05)).ok());
  btCapsuleShapeX sponge(bt(0.05), bt(0.2));
  int removed = 0;
  std::uint64_t reported = 0;
  for (int k = 0; k < 150; ++k) {
    if (k % 10 == 9) removed += water.removeParticles(&sponge, btTransform::getIdentity());
    ASSERT_NO_FATAL_FAILURE(bullet.step(0.002));
    ASSERT_NO_FATAL_FAILURE(water.expect_sound(solver.getReport()));
    reported += solver.getReport().removed;
  }
  EXPECT_GT(removed, 100);
  EXPECT_EQ(reported, static_cast<std::uint64_t>(removed)) << "no other particle has left";
  EXPECT_GT(water.contacts, 1000u);
  int inside_border = 0;  // others ran over it
  for (const Vec3& x : water.getWorld().positions())
    inside_border += x.cwiseAbs().cwiseProduct(Vec3(1, 0, 1)).maxCoeff() < 0.2;
  EXPECT_GT(inside_border, 100);
  EXPECT_EQ(water.carried_by(*cloth), inside_border);
}

TEST(Removal, clear_and_the_limit_of_particles) {
  btFluid water(coarse_fluid(), small_world(), ContactSettings());
  btFluidCoupling coupling(&water);
  EXPECT_EQ(water.getMaxParticles(), 0);
  water.setMaxParticles(60);
  EXPECT_EQ(water.getMaxParticles(), 60);
  ASSERT_TRUE(water.addJet({0, bt(0.5), 0}, {0, -1, 0}, 2, bt(0.05)).ok());
  std::uint64_t lost = 0;
  const auto run = [&] {
    for (int k = 0; k < 60; ++k) {
      lost += coupling.step(bt(0.002)).limited_starts;
      ASSERT_LE(water.getNumParticles(), 60);
    }
  };
  ASSERT_NO_FATAL_FAILURE(run());
  EXPECT_EQ(water.getNumParticles(), 60);
  EXPECT_GT(lost, 0u);
  water.clear();
  EXPECT_EQ(water.getNumParticles(), 0);
  EXPECT_EQ(water.getMass(), 0);
  ASSERT_NO_FATAL_FAILURE(run());
  EXPECT_EQ(water.getNumParticles(), 60);
  std::set<std::uint64_t> ids;
  for (int i = 0; i < 60; ++i) ids.insert(water.getId(i));
  EXPECT_EQ(ids.size(), 60u);
  EXPECT_GT(*ids.begin(), 60u) << "ids are not given twice";
  water.setMaxParticles(-1);
  EXPECT_EQ(water.getMaxParticles(), 0);
  lost = 0;
  for (int k = 0; k < 20; ++k) lost += coupling.step(bt(0.002)).limited_starts;
  EXPECT_EQ(lost, 0u);
  EXPECT_GT(water.getNumParticles(), 60);
}

}  // namespace
}  // namespace oilskin::bullet
